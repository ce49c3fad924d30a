#include "ngs/ops/image/metrics.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/mask_zoo.h"

namespace ngs {
namespace {

using test::Mask;
using test::MaskKind;
using test::zoo_mask;

Mask box(int width_px, int height_px, int x0, int y0, int x1, int y1) {
  Mask mask(width_px, height_px);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) mask.at(x, y) = 1;
  return mask;
}

TEST_CASE("confusion counts every pixel once") {
  const Mask predicted = box(4, 3, 0, 0, 2, 3), truth = box(4, 3, 1, 0, 3, 2);
  const Confusion c = confusion({}, predicted.plane(), truth.plane());
  CHECK(c.tp == 2);
  CHECK(c.fp == 4);
  CHECK(c.fn == 2);
  CHECK(c.tn == 4);
  CHECK(iou(c) == 2.0 / 8);
  CHECK(pixel_accuracy(c) == 6.0 / 12);
  CHECK(class_accuracy(c) == doctest::Approx((2.0 / 4 + 4.0 / 8) / 2));
}

TEST_CASE("confusion throws for planes of different size") {
  const Mask a(4, 3), b(3, 4);
  CHECK_THROWS_AS(confusion({}, a.plane(), b.plane()), std::logic_error);
}

TEST_CASE("squared distances equal a search over all object pixels, and an empty mask has none") {
  for (const auto& [w, h] : {std::pair{1, 1}, {7, 1}, {1, 6}, {13, 9}, {24, 17}})
    for (int kind = 0; kind < int(MaskKind::kCount); ++kind) {
      CAPTURE(kind);
      const Mask mask = zoo_mask(MaskKind(kind), w, h, 3);
      const std::vector<std::int32_t> found = squared_distance(mask.plane());
      int wrong = 0;
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          std::int32_t nearest = kUnbounded;
          for (int at = 0; at < w * h; ++at)
            if (const int dx = x - at % w, dy = y - at / w; mask.at(at % w, at / w) != 0)
              nearest = std::min(nearest, dx * dx + dy * dy);
          wrong += found[std::size_t(y * w + x)] != nearest;
        }
      CHECK(wrong == 0);
    }
  CHECK(squared_distance(Mask(0, 0).plane()).empty());
}

TEST_CASE("scores of an image without pixels and of one pixel are defined") {
  const Mask none(0, 0), off(1, 1), on = box(1, 1, 0, 0, 1, 1);
  const MaskScores nothing = score_mask({}, none.plane(), none.plane());
  for (double value : score_values(nothing)) CHECK(value == 1);
  CHECK(score_mask({}, on.plane(), on.plane()).biou == 1);
  CHECK(score_mask({}, on.plane(), off.plane()).biou == 0);
}

TEST_CASE("two empty masks score 1 everywhere and are flagged") {
  const Mask empty(9, 7);
  const MaskScores s = score_mask({}, empty.plane(), empty.plane());
  for (double value : score_values(s)) CHECK(value == 1);
  CHECK(s.both_empty);
  CHECK_FALSE(s.one_empty);
}

TEST_CASE("one empty mask scores 0 in overlap and contour, whichever side it is, and is flagged") {
  const Mask empty(9, 7);
  // The full mask has no contour inside the image, so contour F needs a branch for it that must not return 1.
  for (const Mask& other : {box(9, 7, 2, 2, 5, 5), box(9, 7, 0, 0, 9, 7)})
    for (bool swap : {false, true}) {
      CAPTURE(swap);
      const MaskScores s =
          swap ? score_mask({}, other.plane(), empty.plane()) : score_mask({}, empty.plane(), other.plane());
      CHECK(s.one_empty);
      CHECK_FALSE(s.both_empty);
      CHECK(s.iou == 0);
      CHECK(s.biou == 0);
      CHECK(s.biou_005 == 0);
      CHECK(s.biou_5px == 0);
      CHECK(s.contour_f == 0);
    }
}

TEST_CASE("class accuracy averages over the classes that occur in the truth") {
  CHECK(class_accuracy({.tp = 0, .fp = 1, .fn = 0, .tn = 3}) == 0.75);  // truth: background only
  CHECK(class_accuracy({.tp = 3, .fp = 0, .fn = 1, .tn = 0}) == 0.75);  // truth: object only
  CHECK(class_accuracy({.tp = 1, .fp = 0, .fn = 1, .tn = 98}) == 0.75);
}

TEST_CASE("counts do not overflow 32 bits") {
  const Confusion c{.tp = 5'000'000'000, .fp = 0, .fn = 5'000'000'000, .tn = 0};
  CHECK(iou(c) == 0.5);
}

TEST_CASE("band width equals the official one: rounded to nearest, ties to even, at least 1 px") {
  CHECK(band_width_px(0.02, 4032, 3024) == 101);
  CHECK(band_width_px(0.02, 1008, 756) == 25);
  CHECK(band_width_px(0.02, 504, 378) == 13);
  CHECK(band_width_px(0.02, 100, 75) == 2);  // 2.5: Python rounds to 2
  CHECK(band_width_px(0.02, 300, 400) == 10);
  CHECK(band_width_px(0.005, 20, 20) == 1);
}

TEST_CASE("chessboard distance counts the image frame as complement only with Outside::kComplement") {
  const Mask full = box(5, 5, 0, 0, 5, 5);
  const auto inside = chessboard_distance(full.plane());
  CHECK(inside[0] == 1);
  CHECK(inside[12] == 3);
  CHECK(chessboard_distance(full.plane(), Outside::kUnknown)[12] == kUnbounded);
  Mask hole = full;
  hole.at(4, 4) = 0;
  CHECK(chessboard_distance(hole.plane(), Outside::kUnknown)[0] == 4);
}

TEST_CASE("signed distance is the distance to the other side, positive in the object, and never 0") {
  const std::vector<std::uint8_t> one_row{0, 0, 1, 1, 1}, none(5, 0), all(5, 1);
  CHECK(signed_distance({one_row.data(), 5, 1}) == std::vector<std::int32_t>{-2, -1, 1, 2, 3});
  CHECK(signed_distance({none.data(), 5, 1}) == std::vector<std::int32_t>(5, -kUnbounded));
  CHECK(signed_distance({all.data(), 5, 1}) == std::vector<std::int32_t>(5, kUnbounded));
}

TEST_CASE("far errors are wrong pixels beyond the wide band of the truth's contour") {
  const Mask truth = box(100, 100, 20, 20, 60, 60);  // band: 3 px
  Mask predicted = box(100, 100, 18, 20, 60, 60);    // 2 px too wide: near
  predicted.at(90, 90) = 1;                          // floater: far
  predicted.at(40, 40) = 0;                          // hole: far
  const MaskScores s = score_mask({}, predicted.plane(), truth.plane());
  CHECK(s.counts.fp == 2 * 40 + 1);
  CHECK(s.far_fp == 1);
  CHECK(s.far_fn == 1);
}

/// A box whose contour lies in a void band of 2 px to either side, as in VOC annotations.
struct VoidBand {
  Mask truth = box(60, 40, 17, 12, 33, 28), is_void = box(60, 40, 15, 10, 35, 30);
  VoidBand() {
    for (int y = 12; y < 28; ++y)
      for (int x = 17; x < 33; ++x) is_void.at(x, y) = x < 19 || x >= 31 || y < 14 || y >= 26;
    for (std::size_t i = 0; i < truth.data.size(); ++i) truth.data[i] = truth.data[i] && !is_void.data[i];
  }
  MaskScores score(const Mask& predicted) const {
    return score_mask({}, predicted.plane(), truth.plane(), 0.008, is_void.plane());
  }
};

TEST_CASE("errors next to a void are counted, and the edge of the void is no contour") {
  const VoidBand band;
  Mask predicted = box(60, 40, 13, 10, 35, 30);  // 2 px beyond the band on one side
  MaskScores s = band.score(predicted);
  CHECK(s.counts.fp == 2 * 20);
  CHECK(s.counts.fn == 0);
  CHECK(s.iou == 144.0 / 184);
  CHECK(s.biou_1px == 0);  // the prediction's contour on that side; the contour of the truth lies in the void
  CHECK(s.biou_3px == 0);
  predicted = box(60, 40, 22, 12, 33, 28);  // 3 px short of the band
  s = band.score(predicted);
  CHECK(s.counts.fn == 3 * 12);
  // Columns of 12 px on either side of the gap; the column of the truth includes its corners.
  CHECK(s.biou_1px == 2.0 / (12 + 16));
}

TEST_CASE("an empty void changes no score; an image that is all void scores like two empty masks") {
  const Mask predicted = box(20, 16, 3, 3, 12, 10), truth = box(20, 16, 5, 2, 13, 9), none(20, 16),
             all = box(20, 16, 0, 0, 20, 16);
  const MaskScores with = score_mask({}, predicted.plane(), truth.plane(), 0.008, none.plane());
  CHECK(score_values(with) == score_values(score_mask({}, predicted.plane(), truth.plane())));
  CHECK(with.void_px == 0);
  const MaskScores nothing = score_mask({}, predicted.plane(), truth.plane(), 0.008, all.plane());
  CHECK(nothing.both_empty);
  for (double value : score_values(nothing)) CHECK(value == 1);
}

TEST_CASE("nearest resize takes the pixel under the destination centre") {
  const std::vector<int> row{0, 1, 2, 3, 4};
  CHECK(resized_nearest(row.data(), 5, 1, 10, 1) == std::vector<int>{0, 0, 1, 1, 2, 2, 3, 3, 4, 4});
  CHECK(resized_nearest(row.data(), 5, 1, 3, 1) == std::vector<int>{0, 2, 4});  // as Pillow
  CHECK(resized_nearest(row.data(), 5, 1, 1, 2) == std::vector<int>{2, 2});
  CHECK(resized_nearest(row.data(), 5, 1, 5, 1) == row);
}

}  // namespace
}  // namespace ngs
