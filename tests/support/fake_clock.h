#pragma once
// Time for tests of time limits: in the scope of a FakeClock only advance() moves wall_seconds().
#include <atomic>
#include <utility>

#include "ngs/core/wall_clock.h"

namespace ngs::test {

class FakeClock {
 public:
  FakeClock() : before_(std::exchange(wall_clock, &FakeClock::now_s)) {}
  ~FakeClock() { wall_clock = before_; }
  FakeClock(const FakeClock&) = delete;
  FakeClock& operator=(const FakeClock&) = delete;

  static void advance(double seconds) { elapsed_s += seconds; }

 private:
  static double now_s() { return elapsed_s; }

  static inline std::atomic<double> elapsed_s = 0;
  double (*before_)();
};

}  // namespace ngs::test
