#include "shared/run/progress_clock.h"

#include <doctest/doctest.h>

namespace ngs::cli {

TEST_CASE("what is left of a part of the work follows its own pace, also where a stage counts anew or is another") {
  ProgressClock clock;
  clock.told("contours", 1, 100);
  CHECK(clock.left_s(12, 100) < 0);  // one piece has no pace
  clock.told("contours", 4, 106);
  CHECK(clock.taken_s(106) == 6);
  CHECK(clock.left_s(12, 106) == 16);  // 8 pieces of 2 s
  clock.told("contours", 12, 122);
  CHECK(clock.left_s(12, 122) == 0);

  clock.told("contours", 1, 130);  // its next part, faster and longer
  clock.told("contours", 11, 131);
  CHECK(clock.taken_s(131) == 1);
  CHECK(clock.left_s(241, 131) == 23);

  clock.told("joint", 20, 140);  // another stage, seen late
  clock.told("joint", 25, 150);
  CHECK(clock.left_s(30, 150) == 10);
  clock.stage_ended();
  clock.told("joint", 26, 200);  // again, after its end
  CHECK(clock.taken_s(200) == 0);
}

}  // namespace ngs::cli
