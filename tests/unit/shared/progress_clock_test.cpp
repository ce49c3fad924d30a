#include <doctest/doctest.h>

#include "shared/progress/chain_clock.h"

namespace ngs::cli {

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
