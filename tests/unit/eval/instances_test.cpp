#include "ngs/eval/instances.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs {
namespace {

/// `count` pixels of one pair of ids.
struct Run {
  std::size_t count;
  std::uint32_t predicted, truth;
};

InstanceCounts counts_of(const std::vector<Run>& runs) {
  InstanceCounts counts;
  for (const Run& run : runs) counts.add(std::vector(run.count, run.predicted), std::vector(run.count, run.truth));
  return counts;
}

}  // namespace

TEST_CASE("panoptic quality and average precision of a scene equal those by hand") {
  // True: 1 has 100 pixels, 2 has 50, 700 has 40. Predictions: 9 has 90 of 1 and 10 of nothing (IoU 90/110); 8 has 30
  // of 2 and 6 of 700 (30/56); 7 has 20 of 700 (20/40: not above a half) and 5 is 60 pixels of nothing.
  const InstanceScores s = score_instances(counts_of({{90, 9, 1},
                                                      {10, 0, 1},
                                                      {10, 9, 0},
                                                      {30, 8, 2},
                                                      {20, 0, 2},
                                                      {6, 8, 700},
                                                      {20, 7, 700},
                                                      {14, 0, 700},
                                                      {60, 5, 0},
                                                      {500, 0, 0}}));
  CHECK(s.matched == 2);
  CHECK(s.sq == doctest::Approx((90.0 / 110 + 30.0 / 56) / 2));
  CHECK(s.rq == doctest::Approx(2 / (2 + 0.5 * 2 + 0.5 * 1)));
  CHECK(s.pq == doctest::Approx((90.0 / 110 + 30.0 / 56) / 3.5));
  // By size: 9 (hit), 5 (none), 8 (hit at up to .53), 7 (hit at up to .5).
  CHECK(s.ap50 == doctest::Approx((1 + 0.75 + 0.75) / 3));  // precisions 1, 2/3, 3/4, made monotonic
  CHECK(s.ap25 == doctest::Approx((1 + 0.75 + 0.75) / 3));
  CHECK(s.ap == doctest::Approx(0.1 * (2.5 / 3 + 6 * (1.0 / 3))));  // at .55 to .80 only 9, above none
  CHECK(s.invented == 1);
  CHECK(s.predicted[0].id == 5);
  CHECK(s.predicted[0].invented);
  CHECK(s.missed == 0);
  CHECK(s.split == 0);
  CHECK(s.merged == 0);
  CHECK(s.truth[2].id == 700);
  CHECK(s.truth[2].best == 7);
  CHECK_FALSE(s.truth[2].matched());
}

TEST_CASE("the ids of a perfect prediction do not matter, and an id that changes between views does") {
  const InstanceScores perfect = score_instances(counts_of({{30, 70000, 1}, {20, 1, 2}}));
  CHECK(perfect.pq == 1);
  CHECK(perfect.ap == doctest::Approx(1));
  // Two views of 15 pixels each, the id changes: both halves have IoU 1/2.
  const InstanceScores changing = score_instances(counts_of({{15, 3, 1}, {15, 4, 1}, {20, 1, 2}}));
  CHECK(changing.matched == 1);
  CHECK(changing.split == 1);
  CHECK(changing.truth[0].split);
  CHECK(changing.pq == doctest::Approx(1 / 2.5));
}

TEST_CASE("merged predictions, split and missed objects are counted, slivers are not parts") {
  const InstanceScores s =
      score_instances(counts_of({{40, 1, 1}, {60, 1, 2}, {10, 2, 3}, {10, 3, 3}, {1, 4, 2}, {30, 0, 4}, {20, 5, 4}}));
  CHECK(s.merged == 1);
  CHECK(s.predicted[0].merged == std::vector<std::uint32_t>{1, 2});
  CHECK(s.split == 1);
  CHECK(s.truth[2].split);
  CHECK_FALSE(s.truth[1].split);  // 4 is a sliver of it
  CHECK(s.missed == 1);
  CHECK(s.truth[3].missed);
}

TEST_CASE("void pixels count nowhere, no prediction scores 0, and no true object is an error") {
  InstanceCounts counts;
  const std::vector<std::uint32_t> predicted = {1, 1, 2, 2}, truth = {1, 1, 0, 3};
  const std::vector<std::uint8_t> is_void = {0, 0, 1, 1};
  counts.add(predicted, truth, is_void);
  CHECK(score_instances(counts).pq == 1);
  CHECK(score_instances(counts_of({{5, 0, 1}})).pq == 0);
  CHECK(score_instances(counts_of({{5, 0, 1}})).ap == 0);
  CHECK_THROWS_WITH_AS(score_instances(counts_of({{5, 1, 0}})), doctest::Contains("no object"), Error);
  CHECK_THROWS_WITH_AS(score_instances({}), doctest::Contains("no object"), Error);
}

TEST_CASE("the boundary IoU of a matched object is that of the two masks, wherever they are in the image") {
  // Squares of 10 and 10 px, shifted by one; in an image of 60x40 the band is 1 px wide: 36 contour pixels each, of
  // which 18 are shared (the parts of the horizontal sides that overlap).
  for (const int offset : {0, 7, 29}) {
    std::vector<std::uint32_t> predicted(60 * 40), truth(60 * 40);
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 10; ++x) {
        truth[std::size_t((y + offset) * 60 + x + offset)] = 3;
        predicted[std::size_t((y + offset) * 60 + x + offset + 1)] = 800;
      }
    const TrueInstance instance{3, 100, 800, 0.8};
    CHECK(instance_biou(predicted, truth, 60, instance) == doctest::Approx(18.0 / (36 + 36 - 18)));
    CHECK(instance_biou(predicted, truth, 60, {4, 1, 5, 0.8}) < 0);
  }
}

}  // namespace ngs
