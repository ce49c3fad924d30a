#include "ngs/ops/field/ray_query.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/field/ray_query_kernels.h"
#include "ngs/ops/field/sample_grid.h"
#include "support/cameras.h"

namespace ngs {
namespace {

Vec3<double> point(const RayQueries& q, std::size_t ray, std::size_t k) {
  const float* p = &q.position[(ray * std::size_t(q.samples) + k) * 3];
  return {p[0], p[1], p[2]};
}

}  // namespace

TEST_CASE("every query point projects back to the pixel of its ray") {
  test::Random random(1);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const Camera camera = test::camera_around(random, 4);
    const PixelGrid grid = pixel_grid({7, 3, 101, 88}, 5, 6);
    const RayQueries q = ray_queries({}, camera, grid, {.samples = 4, .mean_distance = 4}, {});
    REQUIRE(q.rays() == 30);
    for (std::size_t ray = 0; ray < 30; ++ray)
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec2<double> at = test::project(camera, point(q, ray, k));
        CHECK(std::abs(at.x - double(q.pixel[ray * 2])) < 2e-4);  // float positions: 4 eps · f / z = 5e-5 px
        CHECK(std::abs(at.y - double(q.pixel[ray * 2 + 1])) < 2e-4);
        const Vec3<double> d = point(q, ray, k) - camera.centre();
        CHECK(std::sqrt(dot(d, d)) == doctest::Approx(double(q.depth[ray * 4 + k])).epsilon(1e-6));
      }
  }
}

TEST_CASE("a ray direction is a unit vector whose cosine turns distance into depth") {
  test::Random random(2);
  const Camera c = test::camera_around(random, 3);
  double cosine;
  const Vec3<double> d = ray_direction(c.rotation, (13.25 - c.cx) / c.fx, (71.5 - c.cy) / c.fy, cosine);
  CHECK(dot(d, d) == doctest::Approx(1).epsilon(1e-14));
  CHECK((c.rotation * d).z == doctest::Approx(cosine).epsilon(1e-14));
}

TEST_CASE("the samples fill the window evenly from end to end") {
  const DepthWindow<double> w = depth_window(4.0, 0.1, 1e-4, 0.01);
  CHECK(w.near == doctest::Approx(3.6));
  CHECK(w.far == doctest::Approx(4.4));
  CHECK(sample_distance(w, 0, 8) == doctest::Approx(3.6));
  CHECK(sample_distance(w, 7, 8) == doctest::Approx(4.4));
  CHECK(sample_spacing(w, 8) == doctest::Approx(0.8 / 7));
}

TEST_CASE("the window follows the rendered depth where the pixel is covered, else the mean distance") {
  test::Random random(3);
  const Camera camera = test::camera_around(random, 4);
  const PixelGrid grid = pixel_grid({0, 0, 120, 90}, 3, 4);
  ImageF alpha(120, 90, 1, 0.8f), depth(120, 90, 1, 0.8f * 6.f);  // expected z = 6
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 60; ++x) alpha.at(x, y) = 0.3f;  // left half: alpha below 0.5
  const DepthMap map{&depth, &alpha};
  const RayQueries q = ray_queries({}, camera, grid, {.samples = 3, .mean_distance = 4}, map);
  const std::vector<std::uint8_t> on = rays_on_surface(camera, q, map);
  for (std::size_t ray = 0; ray < 12; ++ray) {
    const double middle = double(q.depth[ray * 3 + 1]);
    if (ray % 4 < 2) {
      CHECK(middle == doctest::Approx(4));
      CHECK(on[ray] == 0);  // expected depth 16 is far outside the window around 4
    } else {
      const Vec3<double> t = camera.rotation * point(q, ray, 1) + camera.translation;
      CHECK(t.z == doctest::Approx(6).epsilon(1e-5));
      CHECK(on[ray] == 1);
    }
  }
  const ImageF nothing(120, 90, 1, 0.f);
  CHECK(rays_on_surface(camera, q, {&depth, &nothing}) == std::vector<std::uint8_t>(12, 1));
}

TEST_CASE("an empty grid has no rays") {
  test::Random random(4);
  const RayQueries q = ray_queries({}, test::camera_around(random, 4), {}, {}, {});
  CHECK(q.rays() == 0);
  CHECK(q.position.empty());
}

TEST_CASE("a camera relative to an origin projects to the same pixels") {
  test::Random random(5);
  const Camera world = test::camera_around(random, 4);
  const Camera local = relative_to(world, {1e6, -2e6, 3e5});
  const Vec3<double> p{0.3, -0.2, 0.1};
  const Vec2<double> a = test::project(local, p), b = test::project(world, Vec3<double>{1e6, -2e6, 3e5} + p);
  CHECK(a.x == doctest::Approx(b.x).epsilon(1e-9));
  CHECK(a.y == doctest::Approx(b.y).epsilon(1e-9));
}

TEST_CASE("ray queries are the same bytes for any number of threads") {
  test::Random random(6);
  const Camera camera = test::camera_around(random, 4);
  const PixelGrid grid = pixel_grid({0, 0, 120, 90}, 33, 41);
  Exec seven;
  seven.threads = 7;
  const RayOptions options{.mean_distance = 4};
  CHECK(ray_queries({}, camera, grid, options, {}).position == ray_queries(seven, camera, grid, options, {}).position);
}

}  // namespace ngs
