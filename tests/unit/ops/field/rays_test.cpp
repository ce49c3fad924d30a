#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/field/ray_query_kernels.h"
#include "ngs/ops/field/sample_grid.h"
#include "ngs/ops/field/volume.h"
#include "support/cameras.h"
#include "support/random.h"

namespace ngs {
namespace {

BoundaryBox box_about(std::vector<float> points, double pad_px = 5) {
  return boundary_box(test::camera_along_z(100, 80, 50), {points.data(), std::int64_t(points.size() / 3)}, pad_px);
}

}  // namespace

TEST_CASE("the boundary box spans the projected centres plus the padding") {
  const BoundaryBox b = box_about({0, 0, 1, 0.2f, -0.1f, 2});  // at (50, 40) and (55, 37.5)
  CHECK(b.visible == 2);
  CHECK(b.box.min_x == doctest::Approx(45));
  CHECK(b.box.max_x == doctest::Approx(60));
  CHECK(b.box.min_y == doctest::Approx(32.5));
  CHECK(b.box.max_y == doctest::Approx(45));
  CHECK(b.mean_distance == doctest::Approx((1 + std::sqrt(4.05)) / 2));
}

TEST_CASE("a grid of cell centres has rows x cols nodes, none on the border") {
  const PixelGrid g = pixel_grid({10, 20, 30, 60}, 8, 4);
  CHECK(g.cols == 4);
  CHECK(g.rows == 8);
  CHECK(g.x(0) == 12.5);
  CHECK(g.x(3) == 27.5);
  CHECK(g.y(7) == 57.5);
}

TEST_CASE("box_of(grid) recovers the sampled box for any number of nodes") {
  for (const double width : {0.25, 1.0, 3.75, 100.0})
    for (const int cells : {1, 2, 64}) {
      CAPTURE(width);
      CAPTURE(cells);
      const PixelBox box = box_of(pixel_grid({5, 7, 5 + width, 8}, 64, cells));
      CHECK(box.min_x == doctest::Approx(5).epsilon(1e-12));
      CHECK(box.max_x == doctest::Approx(5 + width).epsilon(1e-12));
      CHECK(box.min_y == 7);
      CHECK(box.max_y == 8);
    }
}

TEST_CASE("bilinear weights of an image position sum to one and list every pixel that is read") {
  for (const int size : {1, 2, 7})
    for (double at = -2; at < 9; at += 0.125) {
      double sum = 0, mean = 0;
      for (int pixel = 0; pixel < size; ++pixel) {
        const double w = bilinear_weight(at, size, pixel);
        sum += w;
        mean += w * pixel;
        CHECK(w >= 0);
      }
      CHECK(sum == 1);
      CHECK(mean == clamp3(at - 0.5, 0.0, size - 1.0));
    }
}

TEST_CASE("the node range of a pixel contains every node that reads the pixel") {
  const PixelGrid grids[] = {pixel_grid({-0.5, 0, 9.7, 5}, 5, 7), pixel_grid({0, 0, 9, 5}, 5, 9),
                             pixel_grid({3.2, 0, 3.9, 5}, 5, 9)};
  for (const PixelGrid& g : grids)
    for (int pixel = 0; pixel < 9; ++pixel) {
      const NodeRange range = nodes_near({g.first_x, g.step_x, g.cols}, 9, pixel, 1.0);
      for (int col = 0; col < g.cols; ++col)
        if (bilinear_weight(g.x(col), 9, pixel) > 0) CHECK((col >= range.first && col <= range.last));
    }
}

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

namespace {

struct Rays {
  int samples;
  std::vector<float> density, rgb, spacing;
  Vec3<float> background;
};
VolumeOutput run(const Rays& r, int threads = 1) {
  const auto count = std::int64_t(r.spacing.size());
  VolumeOutput out;
  volume_forward({.threads = threads},
                 {r.samples, r.density.data(), r.rgb.data(), r.spacing.data(), count, r.background}, out);
  return out;
}

}  // namespace

TEST_CASE("volume: a homogeneous medium follows the Beer-Lambert law") {
  const double sigma = 1.7, spacing = 0.3;
  const VolumeOutput o = run({8, std::vector<float>(8, 1.7f), std::vector<float>(24, 0.5f), {0.3f}, {1, 0, 0.5f}});
  const double alpha = 1 - std::exp(-8 * sigma * spacing);
  CHECK(double(o.alpha[0]) == doctest::Approx(alpha).epsilon(1e-6));
  CHECK(double(o.optical_depth[0]) == doctest::Approx(8 * sigma * spacing).epsilon(1e-6));
  CHECK(double(o.colour[0]) == doctest::Approx(0.5 * alpha + 1 - alpha).epsilon(1e-6));
  CHECK(double(o.colour[1]) == doctest::Approx(0.5 * alpha).epsilon(1e-6));
  CHECK(double(o.colour[2]) == doctest::Approx(0.5).epsilon(1e-6));
}

TEST_CASE("volume: no rays give empty output, rays without samples the background") {
  CHECK(run({8, {}, {}, {}, {0, 0, 0}}).colour.empty());
  const VolumeOutput o = run({0, {}, {}, {1}, {0.5f, 0.5f, 0.5f}});
  CHECK(o.colour == std::vector<float>(3, 0.5f));
  CHECK(o.alpha[0] == 0);
  VolumeGradients g;
  volume_backward({}, {0, nullptr, nullptr, nullptr, 1, {}}, o, {{1, 1, 1}, {1}, {}}, g);
  CHECK(g.density.empty());
}

TEST_CASE("volume: weights sum to alpha and bytes do not depend on the thread count") {
  test::Random random(1);
  const Rays rays{8,
                  random.uniform_vector<float>(8000, 0, 20),
                  random.uniform_vector<float>(24000, 0, 1),
                  random.uniform_vector<float>(1000, 0.01, 0.2),
                  {1, 1, 1}};
  const VolumeOutput a = run(rays), b = run(rays, 7);
  CHECK(a.colour == b.colour);
  for (std::size_t r = 0; r < 1000; ++r) {
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k) sum += double(a.weight[r * 8 + k]);
    CHECK(sum == doctest::Approx(double(a.alpha[r])).epsilon(1e-5));
  }
}

}  // namespace ngs
