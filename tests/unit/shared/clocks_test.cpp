#include <doctest/doctest.h>

#include "shared/progress/chain_clock.h"

namespace ngs::cli {

using Steps = std::vector<ChainStep>;

TEST_CASE("steps of equal pace give the exact fraction and remaining time") {
  ChainClock clock(Steps{{1}, {3}, {6}});
  CHECK(clock.left_s(0) < 0);
  CHECK(clock.done(0) == 0);
  clock.begin(0, 0);
  CHECK(clock.done(0) == 0);
  clock.update(0.5);
  CHECK(clock.done(5) == doctest::Approx(0.05));
  CHECK(clock.left_s(5) == doctest::Approx(95));
  clock.begin(1, 10);
  CHECK(clock.done(10) == doctest::Approx(0.1));
  clock.update(0.5);
  CHECK(clock.done(25) == doctest::Approx(0.25));
  CHECK(clock.left_s(25) == doctest::Approx(75));
  clock.begin(2, 40);
  CHECK(clock.left_s(40) == doctest::Approx(60));
}

TEST_CASE("over restarting passes and a slow step the fraction never falls and the estimate never grows") {
  ChainClock clock(Steps{{1}, {10, true}, {1}});
  clock.begin(0, 0);
  clock.update(1);
  clock.begin(1, 10);  // expected: 100 s; it takes 400
  double done = clock.done(10), left_s = clock.left_s(10);
  for (int t = 0; t < 400; ++t) {
    clock.update(double(t % 29) / 29);
    const double now_s = 10 + t;
    CHECK(clock.done(now_s) >= done);
    CHECK(clock.left_s(now_s) <= left_s);
    done = clock.done(now_s);
    left_s = clock.left_s(now_s);
  }
  CHECK(done < 0.92);
  CHECK(done > 0.9);
  CHECK(left_s >= 0);
  clock.begin(2, 410);
  CHECK(clock.done(410) >= done);
  CHECK(clock.left_s(410) <= left_s);
}

TEST_CASE("with passes a step counts by its expected time, not by its first pass") {
  ChainClock clock(Steps{{1}, {10, true}});
  clock.begin(0, 0);
  clock.begin(1, 10);
  clock.update(0.9);  // of a first, short pass
  CHECK(clock.done(20) == doctest::Approx(2.0 / 11));
  CHECK(clock.left_s(20) == doctest::Approx(90));
  ChainClock first(Steps{{10, true}, {1}});
  first.begin(0, 0);
  first.update(1);
  CHECK(first.left_s(5) < 0);
  CHECK(first.done(5) == doctest::Approx(5.0 / 11));
}

TEST_CASE("steps that are left out do not count") {
  ChainClock clock(Steps{{1}, {5}, {1}});
  clock.begin(0, 0);
  clock.begin(2, 10);
  CHECK(clock.done(10) == doctest::Approx(0.5));
  CHECK(clock.left_s(10) == doctest::Approx(10));
}

TEST_CASE("without steps, or beyond the last one, nothing is known and nothing fails") {
  ChainClock none(Steps{});
  none.begin(0, 0);
  none.update(0.5);
  CHECK(none.done(1) == 0);
  ChainClock one(Steps{{1}});
  one.begin(0, 0);
  one.begin(7, 4);
  CHECK(one.done(5) == 1);
}

TEST_CASE("the remaining time of a part follows its own pace, also if a stage restarts its count or is replaced") {
  ProgressClock clock;
  CHECK(!clock.stage_ended("contours"));
  clock.update("contours", 1, 100);
  CHECK(clock.left_s("contours", 12, 100) < 0);  // one piece has no pace
  clock.update("contours", 4, 106);
  CHECK(clock.taken_s("contours", 106) == 6);
  CHECK(clock.left_s("contours", 12, 106) == 16);  // 8 pieces of 2 s
  clock.update("contours", 12, 122);
  CHECK(clock.left_s("contours", 12, 122) == 0);

  clock.update("contours", 1, 130);  // its next part, faster and longer
  clock.update("contours", 11, 131);
  CHECK(clock.taken_s("contours", 131) == 1);
  CHECK(clock.left_s("contours", 241, 131) == 23);

  clock.update("joint", 20, 140);  // another stage, seen late
  clock.update("joint", 25, 150);
  CHECK(clock.left_s("joint", 30, 150) == 10);
  CHECK(clock.stage_ended("joint"));
  clock.update("joint", 26, 200);  // again, after its end
  CHECK(clock.taken_s("joint", 200) == 0);
}

TEST_CASE("a stage keeps its pace while another tells of its own in between") {
  ProgressClock clock;
  for (int step = 1; step <= 10; ++step) {
    clock.update("joint", step, 100 + step);
    for (int view = 1; view <= 12; ++view) clock.update("score", view, 100 + step + 0.05 * view);
    CHECK(clock.stage_ended("score"));
  }
  CHECK(clock.taken_s("joint", 110) == 9);
  CHECK(clock.left_s("joint", 20, 110) == 10);
}

}  // namespace ngs::cli
