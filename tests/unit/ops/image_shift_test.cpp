#include "ngs/ops/image_shift.h"

#include <doctest/doctest.h>

#include <cmath>

namespace ngs {
namespace {

constexpr int kWidth = 80, kHeight = 64;

/// A smooth texture, moved by (dx, dy).
ImageF texture(double dx, double dy) {
  ImageF image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        const double u = x - dx, v = y - dy;
        image.at(x, y, c) =
            float(0.5 + 0.2 * std::sin(0.31 * u + 0.17 * v + c) + 0.2 * std::cos(0.13 * u - 0.37 * v));
      }
  return image;
}

const ImageF& everywhere() {
  static const ImageF weight(kWidth, kHeight, 1, 1.f);
  return weight;
}

TEST_CASE("a shift is found to a hundredth of a pixel") {
  for (const auto& [dx, dy] : {std::pair{0., 0.}, {0.3, -0.7}, {-1.6, 2.2}, {2.5, 0.}}) {
    CAPTURE(dx);
    CAPTURE(dy);
    const ImageShift shift = find_shift(texture(0, 0), texture(dx, dy), everywhere());
    CHECK(shift.converged);
    CHECK(std::abs(shift.dx_px - dx) < 0.01);
    CHECK(std::abs(shift.dy_px - dy) < 0.01);
    CHECK(shift.error_after <= shift.error_before + 1e-12);
  }
}

TEST_CASE("what only one of the images shows does not pull the shift") {
  ImageF still = texture(0.8, 0.4), moving = texture(0, 0);
  for (int y = 10; y < 30; ++y)
    for (int x = 10; x < 30; ++x)
      for (int c = 0; c < 3; ++c) still.at(x, y, c) = 1.f;  // a sixteenth of the picture
  const ImageShift shift = find_shift(moving, still, everywhere());
  CHECK(std::abs(shift.dx_px - 0.8) < 0.05);
  CHECK(std::abs(shift.dy_px - 0.4) < 0.05);
}

TEST_CASE("without texture, weight or room there is no shift, and nothing is claimed") {
  const ImageF flat(kWidth, kHeight, 3, 0.5f), nothing(kWidth, kHeight, 1, 0.f);
  CHECK(!find_shift(flat, flat, everywhere()).converged);
  CHECK(!find_shift(texture(0, 0), texture(1, 0), nothing).converged);
  const ImageF small(6, 6, 3, 0.2f);
  const ImageShift none = find_shift(small, small, ImageF(6, 6, 1, 1.f));
  CHECK(!none.converged);
  CHECK(none.dx_px == 0);
}

}  // namespace
}  // namespace ngs
