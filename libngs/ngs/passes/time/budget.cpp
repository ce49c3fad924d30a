#include "ngs/passes/time/budget.h"

#include <cmath>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/core/parse_number.h"

namespace ngs {

double Budget::elapsed_s() const { return wall_seconds() - start_s_; }

double Budget::remaining_s() const {
  return seconds_ ? *seconds_ - writing_s_ - elapsed_s() : std::numeric_limits<double>::infinity();
}

double Budget::deadline_s(double share) const { return wall_seconds() + share * remaining_s(); }

void Budget::reserve_for_writing(double reading_s) {
  constexpr double kMin_s = 0.1, kOfReading = 1.5;
  writing_s_ = kMin_s + kOfReading * reading_s;
}

Json Budget::json() const { return {{"seconds", seconds_.value_or(0)}, {"cut", partial_}}; }

std::optional<double> parse_seconds(const std::string& text) {
  if (text.empty()) return std::nullopt;
  double value = 0;
  const auto [stop, error] = scan_number(text.data(), text.data() + text.size(), value);
  const std::string unit(stop, text.data() + text.size());
  const double seconds = unit == "m" ? 60 : unit == "h" ? 3600 : 1;
  const bool known = unit.empty() || unit == "s" || unit == "m" || unit == "h";
  if (error != std::errc() || !std::isfinite(value) || !(value > 0) || !known)
    throw Error(ErrorCode::kUsage, "--time-budget: '" + text + "', expected a time such as 60s, 5m or 1h");
  return value * seconds;
}

}  // namespace ngs
