#include <doctest/doctest.h>

#include <limits>

#include "ngs/core/error.h"
#include "ngs/ops/image/metrics.h"
#include "support/mask_zoo.h"

namespace ngs {
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
