#include "ngs/capture/undistort.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"

namespace ngs {
namespace {

Camera photo_camera() {
  return {.name = "a.png", .width_px = 160, .height_px = 120, .fx = 100, .fy = 102, .cx = 77.5, .cy = 61.25};
}

Lens barrel() { return {.radial = {-0.2, 0.03, 0, 0}, .tangential = {0.002, -0.003}}; }
Lens pincushion() { return {.radial = {0.15, 0.02, 0, 0}}; }
Lens fisheye() { return {.kind = Lens::Kind::kFisheye, .radial = {0.01, -0.002, 0, 0}}; }

/// A smooth pattern at infinity by direction, values 20,000 to 60,000.
double pattern(Vec2<double> direction) {
  return 40000 + 10000 * std::sin(9 * direction.x + 1) + 10000 * std::cos(11 * direction.y);
}

/// The direction that the lens maps to `wanted`, by Newton's method with differences, independent of the inverse in
/// the code under test.
Vec2<double> unbent(const Lens& lens, Vec2<double> wanted) {
  Vec2<double> p = wanted;
  for (int i = 0; i < 50; ++i) {
    constexpr double kStep = 1e-6;
    const Vec2<double> at = distort(lens, p), dx = distort(lens, {p.x + kStep, p.y}),
                       dy = distort(lens, {p.x, p.y + kStep});
    const double a = (dx.x - at.x) / kStep, b = (dy.x - at.x) / kStep, c = (dx.y - at.y) / kStep,
                 d = (dy.y - at.y) / kStep, ex = wanted.x - at.x, ey = wanted.y - at.y, det = a * d - b * c;
    p.x += (d * ex - b * ey) / det;
    p.y += (a * ey - c * ex) / det;
  }
  return p;
}

std::vector<std::uint16_t> photograph(const Camera& camera, const Lens& lens) {
  std::vector<std::uint16_t> photo;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x)
      photo.push_back(std::uint16_t(
          std::lround(pattern(unbent(lens, {(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy})))));
  return photo;
}

double largest_error(const Camera& camera, const Lens& lens, int shrink) {
  const Camera small = resized(camera, camera.width_px / shrink, camera.height_px / shrink);
  const std::vector<std::uint16_t> photo = photograph(small, lens);
  const Camera pinhole = undistorted_camera({camera, lens});
  const std::vector<std::uint16_t> got = undistorted({.threads = 3}, {small.width_px, small.height_px, 1, 16, photo},
                                                     {camera, lens}, pinhole, Resampling::kBilinear);
  double error = 0;
  for (int y = 0; y < pinhole.height_px; ++y)
    for (int x = 0; x < pinhole.width_px; ++x)
      error = std::max(error,
                       std::abs(got[std::size_t(y) * std::size_t(pinhole.width_px) + std::size_t(x)] -
                                pattern({(x + 0.5 - pinhole.cx) / pinhole.fx, (y + 0.5 - pinhole.cy) / pinhole.fy})));
  return error;
}

}  // namespace

TEST_CASE("undistorted: the pinhole image shows the lens photo's values in the same directions") {
  // Error of linear interpolation: h²/8 of each second derivative, 10,000 · (9² + 11²) at 1 px = 1/100,
  // times the square of the largest magnification of the lens (1.7), and 1.5 for two roundings; at the border, where
  // half a pixel of the photo is missing, one first derivative of half a pixel: 10,000 · 11 / 200 more.
  constexpr double kCurved = 10000 * (81 + 121) / 8.0 * 1e-4, kBorder = 10000 * 11 / 200.0;
  for (const Lens& lens : {barrel(), pincushion(), fisheye()})
    CHECK(largest_error(photo_camera(), lens, 1) < kCurved * 3 + kBorder + 1.5);
  // A photo at half the size of the calibration: the derivatives per pixel double.
  CHECK(largest_error(photo_camera(), barrel(), 2) < 4 * kCurved * 3 + 2 * kBorder + 1.5);
  // Without undistortion the error would be most of the range.
  const Camera camera = photo_camera();
  CHECK(std::abs(pattern({0.7, 0.5}) - pattern(distort(barrel(), {0.7, 0.5}))) > 2000);
  CHECK(camera.fx == undistorted_camera({camera, barrel()}).fx);
}

TEST_CASE("pinhole camera: the largest rectangle around the principal point that lies within the photo") {
  const Camera camera = photo_camera();
  for (const Lens& lens : {barrel(), pincushion(), fisheye()}) {
    const Camera pinhole = undistorted_camera({camera, lens});
    double most = -1e9, out = -1e9;  // px beyond the photo: of this rectangle, and of one 3 % larger
    for (int i = 0; i <= 200; ++i)
      for (const double grown : {1.0, 1.03}) {
        const double w = pinhole.width_px, h = pinhole.height_px, t = i / 200.0;
        for (const Vec2<double> px : {Vec2<double>{t * w, 0}, {t * w, h}, {0, t * h}, {w, t * h}}) {
          const Vec2<double> at =
              distort(lens, {grown * (px.x - pinhole.cx) / pinhole.fx, grown * (px.y - pinhole.cy) / pinhole.fy});
          const double x = at.x * camera.fx + camera.cx, y = at.y * camera.fy + camera.cy;
          double& beyond = grown > 1 ? out : most;
          beyond = std::max({beyond, -x, -y, x - camera.width_px, y - camera.height_px});
        }
      }
    CHECK(most < 0.01);
    CHECK(out > 0.1);
    CHECK(pinhole.width_px / double(pinhole.height_px) == doctest::Approx(160 / 120.0).epsilon(0.02));
  }
  const Camera same = undistorted_camera({camera, Lens{}});
  CHECK(same.width_px == 160);
  CHECK(same.cx == doctest::Approx(77.5));
}

TEST_CASE("pinhole camera: a lens that folds the image is used up to the fold, or is an error") {
  Lens folds;
  folds.radial = {-1, 0, 0, 0};  // r (1 - r²) turns back at r = 0.577
  const Camera pinhole = undistorted_camera({photo_camera(), folds});
  const double corner = std::hypot(std::max(pinhole.cx, pinhole.width_px - pinhole.cx) / pinhole.fx,
                                   std::max(pinhole.cy, pinhole.height_px - pinhole.cy) / pinhole.fy);
  CHECK(corner < 0.578);
  CHECK(corner > 0.55);
  Lens wild{.radial = {-1e9, 0, 0, 0}};
  const LensCamera is_wild{photo_camera(), wild};
  CHECK_THROWS_AS(undistorted_camera(is_wild), Error);
  Camera off_centre = photo_camera();
  off_centre.cx = -20;
  const LensCamera looks_aside{off_centre, barrel()};
  CHECK_THROWS_AS(undistorted_camera(looks_aside), Error);
}

TEST_CASE("undistorted: ids are not mixed") {
  const Camera camera = photo_camera();
  std::vector<std::uint16_t> ids(160 * 120);
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = (i % 160 / 8 + i / 160 / 8) % 2 ? 7 : 300;
  const std::vector<std::uint16_t> got = undistorted({}, {160, 120, 1, 16, ids}, {camera, barrel()},
                                                     undistorted_camera({camera, barrel()}), Resampling::kNearest);
  CHECK(std::ranges::count(got, 7) + std::ranges::count(got, 300) == std::ssize(got));
  CHECK(std::ranges::count(got, 7) > 1000);
}

}  // namespace ngs
