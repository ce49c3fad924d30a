#include "ngs/ops/image/metrics.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "ngs/core/error.h"
#include "ngs/ops/image/mask_pair.h"
#include "support/mask_zoo.h"
#include "support/random.h"

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

// Agreement of masks is measured in the box where either mask has foreground. The pixels outside must not matter.

namespace {

constexpr int kWidth_px = 113, kHeight_px = 71, kObjects = 4;  // a band of 3 px; for a part alone it would be 1 px
constexpr std::size_t kPixels = std::size_t(kWidth_px) * kHeight_px;

struct Planes {
  ImageF label{kWidth_px, kHeight_px, kObjects};
  ViewMasks masks{kWidth_px, kHeight_px, {}, {}, true};

  /// Blobs, some cut by the image border, a single pixel, and an object without foreground.
  explicit Planes(std::uint64_t seed) {
    test::Random random(seed);
    masks.target.assign(kObjects, std::vector<float>(kPixels));
    for (int k = 0; k + 1 < kObjects; ++k) {
      blob(random, [&](std::size_t p) -> float& { return label.data[p * kObjects + std::size_t(k)]; });
      if (k > 0) blob(random, [&](std::size_t p) -> float& { return masks.target[std::size_t(k)][p]; });
    }
    masks.target[0][kPixels - 1] = 1;
    masks.known.assign(kPixels, 1);
    for (std::size_t p = 0; p < kPixels; p += 7) masks.known[p] = 0;
  }
  template <class F>
  static void blob(test::Random& random, const F& at) {
    const double x0 = random.uniform(0, kWidth_px), y0 = random.uniform(0, kHeight_px), r = random.uniform(2, 9);
    for (int y = 0; y < kHeight_px; ++y)
      for (int x = 0; x < kWidth_px; ++x) {
        const double d = (x - x0) * (x - x0) + (y - y0) * (y - y0);
        at(std::size_t(y) * kWidth_px + std::size_t(x)) = d < r * r ? 0.9f : 0.2f;
      }
  }
};

/// 0/1 plane of the whole image.
std::vector<std::uint8_t> full_plane(const Planes& of, std::size_t k, bool rendered) {
  std::vector<std::uint8_t> plane(kPixels);
  for (std::size_t p = 0; p < kPixels; ++p)
    plane[p] = of.masks.known[p] && (rendered ? label_is_foreground(of.label.data[p * kObjects + k])
                                              : mask_is_foreground(of.masks.target[k][p]));
  return plane;
}

}  // namespace

TEST_CASE("mask pairs: agreement in the foreground box equals agreement in the whole image") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const Planes of(seed);
    const std::vector<ForegroundBox> boxes = foreground_boxes(of.label);
    REQUIRE(boxes.size() == kObjects);
    for (std::size_t k = 0; k < kObjects; ++k) {
      const MaskPair pair(of.label, of.masks, k, boxes[k]);
      const std::vector<std::uint8_t> rendered = full_plane(of, k, true), own = full_plane(of, k, false);
      const MaskPlane a{rendered.data(), kWidth_px, kHeight_px}, b{own.data(), kWidth_px, kHeight_px};
      const Confusion part = pair.counts({}), all = confusion({}, a, b);
      CHECK(part.both_empty() == all.both_empty());
      if (!all.both_empty()) CHECK(iou(part) == iou(all));
      CHECK(pair.biou({}) == boundary_iou({}, chessboard_distance(a), chessboard_distance(b), kWidth_px,
                                          band_width_px(0.02, kWidth_px, kHeight_px)));
    }
    CHECK(boxes[kObjects - 1].empty());
    CHECK(MaskPair(of.label, of.masks, kObjects - 1, boxes[kObjects - 1]).rendered.empty());
  }
}

namespace {

using test::Mask;

/// A square of 10 px in the middle of 40x40.
Mask square() {
  Mask mask(40, 40);
  for (int y = 15; y < 25; ++y)
    for (int x = 15; x < 25; ++x) mask.at(x, y) = 1;
  return mask;
}

std::vector<float> opacity_of(const Mask& mask) {
  std::vector<float> opacity;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) opacity.push_back(mask.at(x, y) != 0 ? 1.f : 0.f);
  return opacity;
}

TEST_CASE("an opacity equal to the silhouette has neither halo nor holes") {
  const Mask mask = square();
  const OpacityErrors errors = opacity_errors(opacity_of(mask), mask.plane());
  CHECK(errors.contour_px == 36);
  for (const double px : errors.halo_px) CHECK(px == 0);
  for (const double px : errors.holes_px) CHECK(px == 0);
}

TEST_CASE("opacity everywhere is a halo and no opacity is a hole, beyond each band") {
  const Mask mask = square();
  const OpacityErrors full = opacity_errors(std::vector<float>(1600, 1.f), mask.plane());
  const OpacityErrors none = opacity_errors(std::vector<float>(1600, 0.f), mask.plane());
  for (std::size_t b = 0; b < kHaloBands_px.size(); ++b) {
    const int d = kHaloBands_px[b], outer = 10 + 2 * d, inner = 10 - 2 * d;
    CHECK(full.halo_px[b] == doctest::Approx((1600.0 - outer * outer) / 36));
    CHECK(full.holes_px[b] == 0);
    CHECK(none.holes_px[b] == doctest::Approx(double(inner * inner) / 36));
    CHECK(none.halo_px[b] == 0);
  }
}

TEST_CASE("a halo of half opacity counts half") {
  const Mask mask = square();
  std::vector<float> opacity = opacity_of(mask);
  opacity[0] = 0.5f;
  CHECK(opacity_errors(opacity, mask.plane()).halo_px[3] == doctest::Approx(0.5 / 36));
}

TEST_CASE("opacity errors under occluders are not counted") {
  const Mask mask = square();
  Mask occluder(40, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 29; x < 40; ++x) occluder.at(x, y) = 1;
  std::vector<float> opacity = opacity_of(mask);
  opacity[20 * 40 + 35] = 1.f;  // under the occluder
  opacity[20 * 40 + 26] = 1.f;  // next to the occluder, within the margin
  CHECK(opacity_errors(opacity, mask.plane()).halo_px[0] == doctest::Approx(2.0 / 36));
  const OpacityErrors errors = opacity_errors(opacity, mask.plane(), occluder.plane());
  CHECK(errors.halo_px[0] == 0);
  CHECK(errors.contour_px == 36);
}

TEST_CASE("opacity errors of an empty silhouette are 0") {
  const Mask nothing(40, 40);
  const OpacityErrors errors = opacity_errors(std::vector<float>(1600, 1.f), nothing.plane());
  CHECK(errors.contour_px == 0);
  CHECK(errors.halo_px[0] == 0);
}

TEST_CASE("an opacity outside [0, 1] or NaN is an error") {
  const Mask mask = square();
  for (const float bad : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()}) {
    std::vector<float> opacity = opacity_of(mask);
    opacity[7] = bad;
    CHECK_THROWS_AS(opacity_errors(opacity, mask.plane()), Error);
  }
}

}  // namespace
}  // namespace ngs
