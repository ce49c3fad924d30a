// A limit of time: who is told to stop, from when on, and that a loop which would end later is stopped at once.
#include "ngs/core/monitor.h"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

namespace ngs {

TEST_CASE("monitor: a limit asks to stop once its time has come, until its scope ends") {
  Monitor monitor;
  CHECK_FALSE(monitor.stop_requested());
  {
    const Monitor::Limit limit(monitor, wall_seconds() + 1e6);
    CHECK_FALSE(monitor.stop_requested());
    CHECK_FALSE(limit.reached());
  }
  {
    const Monitor::Limit limit(monitor, wall_seconds());
    CHECK_FALSE(limit.reached());  // nobody has been told
    CHECK(monitor.stop_requested());
    CHECK(limit.reached());
  }
  CHECK_FALSE(monitor.stop_requested());
  const Monitor::Limit next(monitor, wall_seconds() + 1e6);
  CHECK_FALSE(next.reached());
}

TEST_CASE("monitor: what a signal stops has reached no limit") {
  Monitor monitor;
  const std::atomic<bool> signal = true;
  monitor.stop_flag(&signal);
  const Monitor::Limit limit(monitor, wall_seconds() + 1e6);
  CHECK(monitor.stop_requested());
  CHECK_FALSE(limit.reached());
}

TEST_CASE("monitor: a loop that is foreseen to end too late is stopped after a tenth of it, another is not") {
  constexpr int kSteps = 100;
  const auto steps_taken = [](double limit_s, std::chrono::milliseconds step) {
    Monitor monitor;
    const Monitor::Limit limit(monitor, wall_seconds() + limit_s);
    int n = 0;
    while (n < kSteps && !monitor.stop_requested()) {
      std::this_thread::sleep_for(step);
      monitor.progress(++n, kSteps);
    }
    return n;
  };
  using std::chrono::milliseconds;
  CHECK(steps_taken(0.5, milliseconds(20)) == kSteps / 10);  // 2 s; the clock alone would stop it at 25
  CHECK(steps_taken(1e6, milliseconds(1)) == kSteps);
}

TEST_CASE("monitor: each loop under a limit is foreseen by itself") {
  Monitor monitor;
  const Monitor::Limit limit(monitor, wall_seconds() + 1);
  monitor.progress(1, 40);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // were it of the next loop, that would take 1.9 s
  for (int n = 1; n <= 40; ++n) monitor.progress(n, 40);
  CHECK_FALSE(monitor.stop_requested());
}

}  // namespace ngs
