#include "latency.h"

#include <algorithm>
#include <cmath>

namespace ngs::studio {

nlohmann::ordered_json Latencies::json() const {
  std::vector<double> sorted = ms;
  std::sort(sorted.begin(), sorted.end());
  const auto at = [&](double share) -> nlohmann::ordered_json {
    if (sorted.empty()) return nullptr;
    const double value = sorted[std::size_t(std::lround(share * double(sorted.size() - 1)))];
    return std::round(10 * value) / 10;
  };
  return {{"n", sorted.size()}, {"median_ms", at(0.5)}, {"p95_ms", at(0.95)}};
}

}  // namespace ngs::studio
