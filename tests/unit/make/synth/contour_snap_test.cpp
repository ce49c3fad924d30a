#include "ngs/make/synth/contour_snap.h"

#include <doctest/doctest.h>

#include <cmath>

namespace ngs::synth {
namespace {

constexpr int kSize = 64;

double radius_at(int x, int y) { return std::hypot(x + 0.5 - kSize / 2.0, y + 0.5 - kSize / 2.0); }

/// Labels of a disc of radius 16.
ImageU16 disc() {
  ImageU16 labels(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) labels.at(x, y) = radius_at(x, y) < 16 ? 1 : 0;
  return labels;
}

/// A photo with an edge of `own` at radius 16, where the disc ends, and one of `wrong` at `wrong_radius`.
ImageF photo(float own, float wrong, double wrong_radius) {
  ImageF photo(kSize, kSize, 3);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x)
      for (int c = 0; c < 3; ++c)
        photo.at(x, y, c) = (radius_at(x, y) < 16 ? own : 0.f) + (radius_at(x, y) < wrong_radius ? wrong : 0.f);
  return photo;
}

/// Radius of a disc of the labels' area.
double radius_of(const ImageU16& labels) {
  double area = 0;
  for (const std::uint16_t id : labels.data) area += id;
  return std::sqrt(area / 3.141592653589793);
}

}  // namespace

TEST_CASE("a contour moves to a stronger edge within reach, on either side") {
  CHECK(radius_of(snap_contours({}, disc(), photo(0.1f, 0.4f, 19), 4)) > 18);
  CHECK(radius_of(snap_contours({}, disc(), photo(0.1f, 0.4f, 13), 4)) < 14);
}

TEST_CASE("a contour stays without a wrong edge, where the wrong edge is weak, and where it is out of reach") {
  const ImageU16 exact = disc();
  CHECK(snap_contours({}, exact, photo(0.2f, 0, 19), 4).data == exact.data);
  // A diagonal step's central differences are sqrt 2 times an upright one's: 0.6 is below 1 / sqrt 2.
  CHECK(snap_contours({}, exact, photo(0.4f, 0.4f * kSnapRatio * 0.6f, 19), 4).data == exact.data);
  CHECK(snap_contours({}, exact, photo(0.1f, 0.4f, 26), 4).data == exact.data);
  CHECK(snap_contours({}, ImageU16(kSize, kSize, 1), photo(0.1f, 0.4f, 19), 4).data == ImageU16(kSize, kSize, 1).data);
}

TEST_CASE("non-finite colours attract no contour, and the thread count does not change the result") {
  ImageF broken = photo(0.1f, 0.4f, 19);
  for (float& v : broken.data)
    if (v == 0.f) v = NAN;
  const ImageU16 exact = disc();
  CHECK(snap_contours({}, exact, broken, 4).data == exact.data);
  const ImageF fine = photo(0.1f, 0.4f, 19);
  CHECK(snap_contours({.threads = 1}, exact, fine, 4).data == snap_contours({.threads = 3}, exact, fine, 4).data);
}

}  // namespace ngs::synth
