#pragma once
// Response times.
#include <nlohmann/json.hpp>
#include <vector>

namespace ngs::studio {

/// Wall time and CPU time of the whole process since construction.
struct Stopwatch {
  Stopwatch();
  double wall_s() const;
  double cpu_s() const;

  double wall_start_s, cpu_start_s;
};

/// Times of one kind of response.
class Latencies {
 public:
  void add(const Stopwatch& watch) {
    wall_ms_.push_back(1000 * watch.wall_s()), cpu_ms_.push_back(1000 * watch.cpu_s());
  }
  /// {"n", "median_ms", "p95_ms", "median_cpu_ms", "p95_cpu_ms"}; times are null if n is 0. CPU
  /// time counts all threads, including those of concurrent responses.
  nlohmann::ordered_json json() const;

 private:
  std::vector<double> wall_ms_, cpu_ms_;
};

}  // namespace ngs::studio
