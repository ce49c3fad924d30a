#include "latency.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/monitor.h"
#include "ngs/os/process_usage.h"

namespace ngs::studio {
namespace {

nlohmann::ordered_json quantile(std::vector<double> ms, double share) {
  if (ms.empty()) return nullptr;
  std::sort(ms.begin(), ms.end());
  return std::round(10 * ms[std::size_t(std::lround(share * double(ms.size() - 1)))]) / 10;
}

}  // namespace

Stopwatch::Stopwatch() : wall_start_s(wall_seconds()), cpu_start_s(os::cpu_seconds()) {}
double Stopwatch::wall_s() const { return wall_seconds() - wall_start_s; }
double Stopwatch::cpu_s() const { return os::cpu_seconds() - cpu_start_s; }

nlohmann::ordered_json Latencies::json() const {
  return {{"n", wall_ms_.size()},
          {"median_ms", quantile(wall_ms_, 0.5)},
          {"p95_ms", quantile(wall_ms_, 0.95)},
          {"median_cpu_ms", quantile(cpu_ms_, 0.5)},
          {"p95_cpu_ms", quantile(cpu_ms_, 0.95)}};
}

}  // namespace ngs::studio
