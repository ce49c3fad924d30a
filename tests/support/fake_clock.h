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

  static void advance(double seconds) { now_s_ += seconds; }

 private:
  static double now_s() { return now_s_; }

  static inline std::atomic<double> now_s_ = 0;
  double (*before_)();
};

}  // namespace ngs::test
