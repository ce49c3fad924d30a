#include "ngs/scene/geometry/stance.h"

#include <doctest/doctest.h>

#include "ngs/orbit/orbit_stage.h"
#include "ngs/scene/geometry/frame.h"
#include "support/splat_shapes.h"

namespace ngs::orbit {
namespace {

/// A surface of revolution about z, open below as no view saw its base; radius[k] at height k · step, linear between.
void add_turned(GaussianCloud& cloud, Vec foot, const std::vector<double>& radius, double step) {
  constexpr double kGrain = 0.03;
  for (double h = 0; h < step * double(radius.size() - 1); h += kGrain) {
    const auto k = std::size_t(h / step);
    const double part = h / step - double(k), r = (1 - part) * radius[k] + part * radius[k + 1];
    const int count = std::max(1, int(2 * 3.14159 * r / kGrain));
    for (int i = 0; i < count; ++i) {
      const double turn = 2 * 3.14159265 * (i + 0.3 * std::fmod(h / kGrain, 7)) / count;
      test::add_gaussian(cloud, foot + Vec{r * std::cos(turn), r * std::sin(turn), h}, 0.5 * kGrain);
    }
  }
}

/// Sitting: as wide as high, with two ears.
GaussianCloud hare() {
  GaussianCloud cloud;
  add_turned(cloud, {0, 0, 0}, {0.42, 0.5, 0.52, 0.5, 0.42, 0.3, 0.05}, 0.1);
  add_turned(cloud, {0.35, 0, 0.35}, {0.05, 0.18, 0.2, 0.18, 0.05}, 0.09);
  for (const double y : {-0.08, 0.08}) add_turned(cloud, {0.3, y, 0.65}, {0.04, 0.06, 0.04, 0.01}, 0.12);
  return cloud;
}

GaussianCloud bust() {
  GaussianCloud cloud;
  add_turned(cloud, {0, 0, 0}, {0.3, 0.3, 0.16, 0.18, 0.42, 0.44, 0.3, 0.14, 0.13, 0.22, 0.25, 0.22, 0.04}, 0.1);
  return cloud;
}

GaussianCloud figure_on_disc() {
  GaussianCloud cloud;
  add_turned(cloud, {0, 0, 0}, {0.3, 0.3, 0.12, 0.14, 0.16, 0.2, 0.18, 0.07, 0.11, 0.02}, 0.16);
  test::add_box(cloud, {-0.35, -0.05, 0.9}, {0.35, 0.05, 1}, 0.03);  // arms
  return cloud;
}

/// A pot, and leaves that reach farther than the pot.
GaussianCloud plant() {
  GaussianCloud cloud;
  add_turned(cloud, {0, 0, 0}, {0.2, 0.22, 0.25, 0.27}, 0.1);
  for (int k = 0; k < 40; ++k) {
    const double turn = 2.4 * k, out = 0.2 + 0.009 * k, high = 0.35 + 0.5 * std::fmod(0.618 * k, 1);
    test::add_sphere(cloud, {out * std::cos(turn), out * std::sin(turn), high}, 0.06, 40);
  }
  return cloud;
}

GaussianCloud person() {
  GaussianCloud cloud;
  for (const double x : {-0.13, 0.13}) {
    add_turned(cloud, {x, 0, 0}, {0.06, 0.07, 0.08, 0.1, 0.1}, 0.2);
    test::add_box(cloud, {x - 0.06, -0.2, 0}, {x + 0.06, 0.06, 0.06}, 0.03);  // feet
    add_turned(cloud, {2.2 * x, 0, 0.75}, {0.03, 0.05, 0.06, 0.06}, 0.22);    // arms
  }
  add_turned(cloud, {0, 0, 0.78}, {0.17, 0.16, 0.2, 0.08, 0.11, 0.12, 0.03}, 0.17);
  return cloud;
}

GaussianCloud guitar_on_stand() {
  GaussianCloud cloud;
  for (int k = 0; k < 3; ++k)  // the legs of the stand
    for (double t = 0; t < 1; t += 0.02)
      test::add_sphere(cloud, {0.3 * t * std::cos(2.1 * k), 0.3 * t * std::sin(2.1 * k), 0.3 * (1 - t)}, 0.015, 12);
  test::add_box(cloud, {-0.2, -0.05, 0.15}, {0.2, 0.05, 0.65}, 0.03);
  test::add_box(cloud, {-0.03, -0.02, 0.65}, {0.03, 0.02, 1.3}, 0.02);
  test::add_box(cloud, {-0.06, -0.02, 1.3}, {0.06, 0.02, 1.45}, 0.02);
  return cloud;
}

struct Thing {
  std::string name;
  GaussianCloud cloud;  // upright, z up
};
std::vector<Thing> things() {
  return {{"hare", hare()},   {"bust", bust()},     {"figure", figure_on_disc()},
          {"plant", plant()}, {"person", person()}, {"guitar", guitar_on_stand()}};
}

Stance stance_of(const GaussianCloud& cloud) {
  const SurfacePoints points = surface_points(cloud);
  return best_stance(points, bulk_of(points));
}

/// The rotation that takes +z to an axis.
Mat3<double> z_to(Vec up) {
  const Vec a = perpendicular(up), b = cross(up, a);
  return {{a.x, b.x, up.x, a.y, b.y, up.y, a.z, b.z, up.z}};
}

}  // namespace

TEST_CASE("an object without a floor stands upright, whichever axis of its file points upwards") {
  for (const Thing& thing : things())
    for (const Vec& up : {Vec{0, 0, 1}, Vec{0, 1, 0}, Vec{0, -1, 0}, Vec{1, 0, 0}, Vec{-1, 0, 0}, Vec{0, 0, -1}}) {
      const GaussianCloud cloud = test::transformed(thing.cloud, z_to(up), 2, {0.3, -1, 4});
      const SurfacePoints points = surface_points(cloud);
      CAPTURE(thing.name);
      CAPTURE(up.x);
      CAPTURE(up.y);
      CAPTURE(best_stance(points, bulk_of(points)).value);
      CHECK(dot(guess_up(points, bulk_of(points)).up, up) > 0.99);
    }
}

TEST_CASE("the cameras around a tall object show all of it") {
  for (const Thing& thing : things()) {
    Monitor monitor;
    OrbitOptions options{.around = {}, .view_count = 8};
    const OrbitCameras found = choose_cameras({.threads = 2}, monitor, thing.cloud, options, {120, 90});
    CAPTURE(thing.name);
    CHECK(found.up.z > 0.99);
    std::size_t outside = 0;
    for (const Camera& camera : found.cameras)
      for (std::int64_t i = 0; i < thing.cloud.size(); ++i) {
        const float* p = &thing.cloud.position[3 * std::size_t(i)];
        outside += !camera.project({double(p[0]), double(p[1]), double(p[2])}).has_value();
      }
    CHECK(double(outside) <= 0.002 * double(found.cameras.size()) * double(thing.cloud.size()));
  }
}

TEST_CASE("a ball and its far floaters stand on no side, and nothing has no stance") {
  GaussianCloud cloud;
  test::add_sphere(cloud, {0, 0, 0}, 1, 800);
  CHECK_FALSE(stance_of(cloud).is_clear());
  for (int k = 0; k < 20; ++k) test::add_gaussian(cloud, {40.0 + k, 3.0 * k, -90}, 2);
  const SurfacePoints points = surface_points(cloud);
  CHECK_FALSE(stance_of(cloud).is_clear());
  const Ball bulk = bulk_of(points);
  CHECK(ball_to_frame(points, bulk, {0, 0, 1}).radius == bulk.radius);
  CHECK(stance(SurfacePoints(), {0, 0, 1}) == 0);
}

}  // namespace ngs::orbit
