#include "ngs/cut/passes/time/budget.h"

#include <limits>

#include "ngs/core/monitor.h"

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

}  // namespace ngs
