// Time limits: when stop_requested() becomes true, and that a loop that would end too late is stopped early.
#include "ngs/core/monitor.h"

#include <doctest/doctest.h>

#include "support/fake_clock.h"

namespace ngs {

TEST_CASE("monitor: stop_requested is true from the deadline of a limit to the end of its scope") {
  Monitor monitor;
  CHECK_FALSE(monitor.stop_requested());
  {
    const Monitor::Limit limit(monitor, wall_seconds() + 1e6);
    CHECK_FALSE(monitor.stop_requested());
    CHECK_FALSE(limit.reached());
  }
  {
    const Monitor::Limit limit(monitor, wall_seconds());
    CHECK_FALSE(limit.reached());  // stop_requested() was not called yet
    CHECK(monitor.stop_requested());
    CHECK(limit.reached());
  }
  CHECK_FALSE(monitor.stop_requested());
  const Monitor::Limit next(monitor, wall_seconds() + 1e6);
  CHECK_FALSE(next.reached());
}

TEST_CASE("monitor: a stop by signal does not mark the limit as reached") {
  Monitor monitor;
  const std::atomic<bool> signal = true;
  monitor.stop_flag(&signal);
  const Monitor::Limit limit(monitor, wall_seconds() + 1e6);
  CHECK(monitor.stop_requested());
  CHECK_FALSE(limit.reached());
}

TEST_CASE("monitor: a loop that is estimated to end after the deadline is stopped after a tenth of its steps") {
  constexpr int kSteps = 100;
  const test::FakeClock clock;
  const auto steps_taken = [&](double limit_s, double step_s) {
    Monitor monitor;
    const Monitor::Limit limit(monitor, wall_seconds() + limit_s);
    int n = 0;
    while (n < kSteps && !monitor.stop_requested()) {
      clock.advance(step_s);
      monitor.progress(++n, kSteps);
    }
    return n;
  };
  CHECK(steps_taken(0.5, 0.02) == kSteps / 10);  // would take 2 s; the deadline alone would stop it at 25
  CHECK(steps_taken(1e6, 0.001) == kSteps);
}

TEST_CASE("monitor: the end of each loop under a limit is estimated from its own steps") {
  const test::FakeClock clock;
  Monitor monitor;
  const Monitor::Limit limit(monitor, wall_seconds() + 1);
  monitor.progress(1, 40);
  // If the next loop were timed from here, it would be estimated to take 1.9 s.
  clock.advance(0.1);
  for (int n = 1; n <= 40; ++n) monitor.progress(n, 40);
  CHECK_FALSE(monitor.stop_requested());
}

}  // namespace ngs
