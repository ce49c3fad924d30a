#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/image/metrics.h"
#include "support/mask_zoo.h"

namespace ngs {
namespace {

using test::Mask;
using test::MaskKind;

struct Pair {
  Mask predicted, truth;
};

/// The n-th pair of masks: all combinations of mask kinds, at sizes from 1x1 to 48x48.
Pair nth_pair(std::uint64_t n) {
  const int kinds = int(MaskKind::kCount);
  const auto side = [&](std::uint64_t i) { return 1 + int(rng_bits(7, RngStream::kTest, 4 * n + i) % 48); };
  const int width = side(0), height = side(1);
  return {test::zoo_mask(MaskKind(int(n) % kinds), width, height, 2 * n),
          test::zoo_mask(MaskKind(int(n) / kinds % kinds), width, height, 2 * n + 1)};
}

double boundary_iou_by_erosion(const Mask& predicted, const Mask& truth, int d) {
  const Mask p = test::boundary_band(predicted, d), t = test::boundary_band(truth, d);
  const Confusion c = confusion({}, p.plane(), t.plane());
  return c.both_empty() ? 1.0 : double(c.tp) / double(c.tp + c.fp + c.fn);
}

TEST_CASE("boundary IoU equals the definition by repeated erosion on 1000 random and adversarial masks") {
  for (std::uint64_t n = 0; n < 1000; ++n) {
    CAPTURE(n);
    const Pair pair = nth_pair(n);
    const auto p = chessboard_distance(pair.predicted.plane()), t = chessboard_distance(pair.truth.plane());
    // Compares the pixels of the bands, not only their number.
    for (int d : {1, 2, 3, 5, 9}) {
      CAPTURE(d);
      const Mask band = test::boundary_band(pair.predicted, d);
      bool same = true;
      for (std::size_t i = 0; i < p.size(); ++i) same = same && (band.data[i] != 0) == (p[i] > 0 && p[i] <= d);
      REQUIRE(same);
      REQUIRE(boundary_iou({}, p, t, pair.truth.width_px, d) == boundary_iou_by_erosion(pair.predicted, pair.truth, d));
    }
    const MaskScores s = score_mask({}, pair.predicted.plane(), pair.truth.plane());
    const int w = pair.truth.width_px, h = pair.truth.height_px;
    REQUIRE(s.biou == boundary_iou_by_erosion(pair.predicted, pair.truth, band_width_px(0.02, w, h)));
    REQUIRE(s.biou_005 == boundary_iou_by_erosion(pair.predicted, pair.truth, band_width_px(0.005, w, h)));
    REQUIRE(s.biou_5px == boundary_iou_by_erosion(pair.predicted, pair.truth, 5));
  }
}

TEST_CASE("boundary IoU with a band wider than the image equals IoU") {
  for (std::uint64_t n = 0; n < 60; ++n) {
    CAPTURE(n);
    const Pair pair = nth_pair(n);
    const auto p = chessboard_distance(pair.predicted.plane()), t = chessboard_distance(pair.truth.plane());
    CHECK(boundary_iou({}, p, t, pair.truth.width_px, 100) ==
          iou(confusion({}, pair.predicted.plane(), pair.truth.plane())));
  }
}

TEST_CASE("overlap and contour scores are symmetric, lie in [0, 1] and are 1 for equal masks") {
  for (std::uint64_t n = 0; n < 300; ++n) {
    CAPTURE(n);
    const Pair pair = nth_pair(n);
    const MaskScores ab = score_mask({}, pair.predicted.plane(), pair.truth.plane());
    const MaskScores ba = score_mask({}, pair.truth.plane(), pair.predicted.plane());
    const MaskScores aa = score_mask({}, pair.truth.plane(), pair.truth.plane());
    CHECK(ab.iou == ba.iou);
    CHECK(ab.accuracy == ba.accuracy);
    CHECK(ab.biou == ba.biou);
    CHECK(ab.biou_1px == ba.biou_1px);
    CHECK(ab.contour_f == doctest::Approx(ba.contour_f).epsilon(1e-15));
    for (double value : score_values(ab)) CHECK((value >= 0 && value <= 1));
    for (double value : score_values(aa)) CHECK(value == 1);
  }
}

/// The definition, by all pairs of contour pixels. Void pixels are matched with but not counted.
double contour_f_by_all_pairs(const Mask& predicted, const Mask& truth, int tolerance_px, const Mask& is_void = {}) {
  const auto contour = [](const Mask& m) {
    std::vector<std::pair<int, int>> points;
    for (int y = 0; y < m.height_px; ++y)
      for (int x = 0; x < m.width_px; ++x) {
        const auto off = [&](int i, int j) {
          return i >= 0 && j >= 0 && i < m.width_px && j < m.height_px && m.at(i, j) == 0;
        };
        if (m.at(x, y) && (off(x - 1, y) || off(x + 1, y) || off(x, y - 1) || off(x, y + 1))) points.emplace_back(x, y);
      }
    return points;
  };
  const auto p = contour(predicted), t = contour(truth);
  const auto share = [&](const auto& from, const auto& to) {
    double matched = 0, count = 0;
    for (auto [x, y] : from) {
      if (!is_void.data.empty() && is_void.at(x, y)) continue;
      bool near = false;
      ++count;
      for (auto [u, v] : to) near = near || (x - u) * (x - u) + (y - v) * (y - v) <= tolerance_px * tolerance_px;
      matched += near;
    }
    return count == 0 ? 1.0 : matched / count;
  };
  const double precision = share(p, t), recall = share(t, p);
  return precision + recall == 0 ? 0.0 : 2 * precision * recall / (precision + recall);
}

TEST_CASE("contour F equals the definition by all pairs of contour pixels") {
  for (std::uint64_t n = 0; n < 300; ++n)
    for (int tolerance : {0, 1, 3, 8}) {
      CAPTURE(n);
      CAPTURE(tolerance);
      const Pair pair = nth_pair(n);
      CHECK(contour_f(pair.predicted.plane(), pair.truth.plane(), tolerance) ==
            contour_f_by_all_pairs(pair.predicted, pair.truth, tolerance));
    }
}

TEST_CASE("with void pixels every score equals that of the truth filled with the prediction, void not counted") {
  for (std::uint64_t n = 0; n < 600; ++n) {
    CAPTURE(n);
    const Pair pair = nth_pair(n);
    const int w = pair.truth.width_px, h = pair.truth.height_px;
    const Mask is_void = test::zoo_mask(MaskKind(int(n / 7) % int(MaskKind::kCount)), w, h, 9000 + n);
    Mask truth = pair.truth;
    for (std::size_t i = 0; i < truth.data.size(); ++i)
      if (is_void.data[i]) truth.data[i] = pair.predicted.data[i];
    const auto iou_of = [&](const Mask& a, const Mask& b) {
      double both = 0, any = 0;
      for (std::size_t i = 0; i < a.data.size(); ++i) {
        both += a.data[i] && b.data[i] && !is_void.data[i];
        any += (a.data[i] || b.data[i]) && !is_void.data[i];
      }
      return any == 0 ? 1.0 : both / any;
    };
    const MaskScores s = score_mask({}, pair.predicted.plane(), pair.truth.plane(), 0.05, is_void.plane());
    REQUIRE(s.iou == iou_of(pair.predicted, pair.truth));
    for (auto [d, biou] :
         {std::pair{1, s.biou_1px}, {3, s.biou_3px}, {5, s.biou_5px}, {band_width_px(0.02, w, h), s.biou}})
      REQUIRE(biou == iou_of(test::boundary_band(pair.predicted, d), test::boundary_band(truth, d)));
    const int tolerance_px = int(std::ceil(0.05 * std::sqrt(double(w) * w + double(h) * h)));
    if (!s.one_empty) REQUIRE(s.contour_f == contour_f_by_all_pairs(pair.predicted, truth, tolerance_px, is_void));
  }
}

TEST_CASE("scores do not depend on the thread count") {
  for (std::uint64_t n = 0; n < 50; ++n) {
    const Pair pair = nth_pair(n);
    CHECK(score_values(score_mask({}, pair.predicted.plane(), pair.truth.plane())) ==
          score_values(score_mask({.threads = 7}, pair.predicted.plane(), pair.truth.plane())));
  }
}

}  // namespace
}  // namespace ngs
