#pragma once
// How long answers took.
#include <nlohmann/json.hpp>
#include <vector>

namespace ngs::studio {

/// From its making on: the clock on the wall, and the processor's time of the whole process.
struct Stopwatch {
  Stopwatch();
  double wall_s() const;
  double cpu_s() const;

  double wall_start_s, cpu_start_s;
};

/// Times of one kind of answer.
class Latencies {
 public:
  void add(const Stopwatch& watch) {
    wall_ms_.push_back(1000 * watch.wall_s()), cpu_ms_.push_back(1000 * watch.cpu_s());
  }
  /// {"n", "median_ms", "p95_ms", "median_cpu_ms", "p95_cpu_ms"}; null times where there are none. The processor's time
  /// is that of all threads, and of other answers under way at the same time.
  nlohmann::ordered_json json() const;

 private:
  std::vector<double> wall_ms_, cpu_ms_;
};

}  // namespace ngs::studio
