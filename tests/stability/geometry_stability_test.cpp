// Boxes, grids, rays and depth windows.                                                         Eqs. (4)-(7)
#include <doctest/doctest.h>

#include "ngs/ops/field/ray_query.h"
#include "ngs/ops/field/ray_query_kernels.h"
#include "ngs/ops/field/sample_grid.h"
#include "ngs/problem/object_core.h"
#include "support/cameras.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

std::vector<float> points_near_origin(Random& random, int n) {
  return random.uniform_vector<float>(std::size_t(n) * 3, -0.5, 0.5);
}

BoundaryBox box_of(const Camera& camera, const std::vector<float>& points, double pad = 5) {
  return boundary_box(camera, {points.data(), std::int64_t(points.size() / 3)}, pad);
}

RayQueries rays_of(const Camera& camera, const PixelGrid& grid, int samples, double mean_distance,
                   const DepthMap& map = {}) {
  return ray_queries({}, camera, grid, {.samples = samples, .mean_distance = mean_distance}, map);
}

bool finite(const RayQueries& rays) {
  bool fine = true;
  for (const auto* values : {&rays.position, &rays.depth, &rays.near, &rays.far, &rays.spacing, &rays.direction})
    for (const float x : *values) fine &= std::isfinite(x);
  return fine;
}

PixelGrid one_node(double x, double y) { return {.first_x = x, .first_y = y, .cols = 1, .rows = 1}; }

}  // namespace

HARD_CASE("geometry: without boundary Gaussians there is no box, no grid and no ray", "|B|", {40, 0}, 0,
          {"nodes of the least and the greatest coordinate", test::kWrong}) {
  const Camera camera = test::camera_around(random, 3);
  const std::vector<float> points = points_near_origin(random, int(h));
  const BoundaryBox box = box_of(camera, points, 0);
  const PixelGrid grid = pixel_grid(box.box, 8, 8);
  worst.ours_is(box.visible == int(h) && grid.nodes() == (h > 0 ? 64 : 0) &&
                rays_of(camera, grid, 4, 0).rays() == grid.nodes());
  double low = INFINITY, high = -INFINITY;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const double x = test::project(camera, {points[i], points[i + 1], points[i + 2]}).x;
    low = std::min(low, x);
    high = std::max(high, x);
  }
  const double step = (high - low) / 8, last = low + 7.5 * step;
  worst.naive_is(std::abs(last - (grid.nodes() > 0 ? grid.x(7) : 0.0)) < 1e-3);
}

HARD_CASE("geometry: one, two and a few Gaussians have a box with at least a node", "|B|", {40, 3, 2, 1}, 0,
          {"steps of a box without area", test::kWrong}) {
  const Camera camera = test::camera_around(random, 3);
  const BoundaryBox box = box_of(camera, points_near_origin(random, int(h)), 0);
  const PixelGrid grid = pixel_grid(box.box, 8, 8);
  const bool degenerate = !(box.box.max_x > box.box.min_x) || !(box.box.max_y > box.box.min_y);
  worst.ours_is(box.visible == int(h) && (grid.nodes() > 0) == !degenerate && grid.step_x >= 1 && grid.step_y >= 1);
  worst.naive_is((box.box.max_x - box.box.min_x) / 8 >= 1 && (box.box.max_y - box.box.min_y) / 8 >= 1);
}

HARD_CASE("geometry: Gaussians behind the camera are not visible, even if their mirror image would be",
          "camera z, world", {1, 0.009, 0, -1e-6, -3}, 0, {"x / z whatever the sign of z", test::kWrong}) {
  Camera camera = test::camera_around(random, 0);
  const Vec3<double> t{0.01 * h, -0.01 * h, h}, p = transpose(camera.rotation) * t;
  const BoundaryBox box = box_of(camera, {float(p.x), float(p.y), float(p.z)});
  worst.ours_is(box.visible == (h > 0.5 ? 1 : 0));
  const double x = camera.fx * t.x / t.z + camera.cx;
  const bool seen = x >= 0 && x <= camera.width_px;
  worst.naive_is(seen == (h > 0.5));
}

HARD_CASE("geometry: a box outside the image is empty, not negative", "offset, px", {0, 200, 1e4, 1e6}, 0,
          {"min and max clipped to the image", test::kWrong}) {
  const Camera camera = test::camera_around(random, 3);
  std::vector<float> points = points_near_origin(random, 5);
  const Vec3<double> shift = transpose(camera.rotation) * Vec3<double>{h * 3 / camera.fx, 0, 0};
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += float((&shift.x)[i % 3]);
  const BoundaryBox box = box_of(camera, points);
  worst.ours_is(box.box.max_x >= box.box.min_x && box.box.max_y >= box.box.min_y && (h < 1e3 || box.visible == 0));
  const double x = test::project(camera, {points[0], points[1], points[2]}).x;
  worst.naive_is(std::min(x + 5, double(camera.width_px)) >= std::max(x - 5, 0.0));
}

HARD_CASE("geometry: a box larger than the image is the image", "spread, world", {0.1, 1, 2}, 0,
          "not applicable: clipping has one form") {
  const Camera camera = test::camera_around(random, 3);
  std::vector<float> points;
  for (int i = 0; i < 400; ++i) {
    const Vec3<double> t{h * random.uniform(-1, 1), h * random.uniform(-1, 1), 0}, p = transpose(camera.rotation) * t;
    points.insert(points.end(), {float(p.x), float(p.y), float(p.z)});
  }
  const PixelBox box = box_of(camera, points, 30).box;
  worst.ours_is(box.min_x >= 0 && box.min_y >= 0 && box.max_x <= camera.width_px && box.max_y <= camera.height_px);
  if (h == 2) worst.ours_is(box.min_x == 0 && box.max_y == camera.height_px);
}

HARD_CASE("geometry: grids over boxes of a pixel, of less and of nothing keep steps of a pixel or more", "box, px",
          {100, 2, 1, 0.3, 0}, 0, {"step = length / cells", test::kWrong}) {
  const double x = random.uniform(0, 50), y = random.uniform(0, 50);
  {
    const PixelGrid grid = pixel_grid({x, y, x + h, y + h}, 64, 64);
    bool fine = (grid.nodes() == 0) == (h == 0) && grid.step_x >= 1;
    if (grid.nodes() > 0) fine &= grid.first_x >= x && grid.x(grid.cols - 1) <= x + h + 1e-12;
    worst.ours_is(fine);
  }
  worst.naive_is(h / 64 >= 1);
}

HARD_CASE("geometry: a single sample lies in the middle of its window", "samples", {8, 2, 1}, 0.48,
          {"δ_k = -1 + 2k / (K - 1)", test::kWrong}) {
  const float centre = float(random.uniform(1, 10));
  const DepthWindow<float> window = depth_window(centre, 0.1f, 1e-4f, 0.01f);
  const int samples = int(h);
  const Real middle = (Real(window.near) + window.far) / 2;
  const Real first = samples == 1 ? middle : Real(window.near);
  worst.ours(sample_distance(window, 0, samples), first);
  worst.ours_is(sample_spacing(window, samples) > 0 && std::isfinite(sample_spacing(window, samples)));
  const float k = 0, delta = -1 + 2 * k / float(samples - 1);
  worst.naive(centre * (1 + 0.1f * delta), first);
}

HARD_CASE("geometry: the first and last sample are exactly the ends of the window", "samples", {2, 8, 33, 1000}, 1.1,
          {"near + k · step, accumulated", 80}) {
  const DepthWindow<float> window{float(random.uniform(1, 10)), float(random.uniform(11, 20))};
  const int samples = int(h);
  worst.ours_is(sample_distance(window, 0, samples) == window.near &&
                sample_distance(window, samples - 1, samples) == window.far);
  const float step = (window.far - window.near) / float(samples - 1);
  float naive = window.near;
  for (int k = 0; k < samples; ++k) {
    const Real want = Real(window.near) + (Real(window.far) - window.near) * k / (samples - 1);
    worst.ours(sample_distance(window, k, samples), want, 2);
    worst.naive(naive, want, 2);
    naive += step;
  }
}

HARD_CASE("geometry: a window that would cross the camera starts in front of it", "distance, world",
          {1, 0.01, 1e-3, 1e-6}, 0, {"t - max(span t, ε)", test::kWrong}) {
  const Camera camera = test::camera_around(random, 3);
  const RayQueries rays = rays_of(camera, one_node(random.uniform(0, 120), random.uniform(0, 90)), 5, h);
  worst.ours_is(finite(rays) && rays.near[0] > 0 && rays.near[0] <= rays.far[0] && rays.spacing[0] >= 0 &&
                rays.depth[0] >= rays.near[0]);
  worst.naive_is(h - std::max(0.1 * h, 1e-4) > 0);
}

HARD_CASE("geometry: a mean distance of zero gives a window in front of the camera and a unit direction",
          "distance, world", {1, 1e-3, 0}, 0, {"directions as t d / |t d|", test::kWrong}) {
  const Camera camera = test::camera_around(random, 3);
  for (const int samples : {1, 2, 8}) {
    const RayQueries rays = rays_of(camera, one_node(random.uniform(0, 120), random.uniform(0, 90)), samples, h);
    worst.ours_is(finite(rays) && rays.near[0] >= float(kNearZ) && rays.spacing[0] >= 0);
    const Vec3<float> d = vec3<float>(rays.direction.data()), x = float(h) * d;
    worst.ours_is(std::abs(dot(d, d) - 1) < 1e-6f);
    worst.naive_is(std::abs(dot(d, x) / std::sqrt(dot(x, x)) - 1) < 1e-6f);
  }
}

HARD_CASE("geometry: directions far off the axis are unit vectors to rounding", "slope", {0.1, 10, 1e4, 1e15}, 2.2,
          {"sqrt(1 - x² - y²) for the third component", test::kWrong}) {
  const Mat3<float> axes{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const float u = float(h * random.uniform(0.5, 1)), v = float(h * random.uniform(0.5, 1));
  float cosine;
  const Vec3<float> d = ray_direction(axes, u, v, cosine);
  const Real length = std::sqrt(Real(u) * u + Real(v) * v + 1);
  worst.ours(d.x, u / length);
  worst.ours(d.y, v / length);
  worst.ours(d.z, 1 / length);
  worst.ours(cosine, 1 / length);
  worst.naive(std::sqrt(1 - d.x * d.x - d.y * d.y), 1 / length);
}

HARD_CASE("geometry: query points of a scene far from its origin keep their details", "offset, world",
          {0, 1e2, 1e4, 1e6}, 1, {"o + t d in world coordinates, in float", 4e4}) {
  Camera camera = test::camera_around(random, 3);
  const PixelGrid node = one_node(random.uniform(0, 120), random.uniform(0, 90));
  const std::array<double, 3> origin{h, -0.5 * h, 0.25 * h};
  const RayQueries near_origin = rays_of(camera, node, 3, 2.5);
  Camera far_camera = camera;
  far_camera.translation = far_camera.translation - camera.rotation * Vec3<double>{origin[0], origin[1], origin[2]};
  const RayQueries far_away = rays_of(relative_to(far_camera, origin), node, 3, 2.5);
  for (std::size_t i = 0; i < 9; ++i) {
    const double want = double(near_origin.position[i]), size = 3;  // of the scene
    worst.ours_ratio(std::abs(double(far_away.position[i]) - want) / (0x1p-23 * size));
    const float world = float(double(near_origin.position[i]) + origin[i % 3]);
    worst.naive_ratio(std::abs(double(world) - origin[i % 3] - want) / (0x1p-23 * size));
  }
}

HARD_CASE("geometry: a depth map with low alpha leaves the window unchanged", "alpha", {1, 0.6, 1e-2, 1e-30, 0}, 0,
          {"depth / alpha", test::kWrong}) {
  const Camera camera = test::camera_around(random, 3);
  const float distance = float(random.uniform(1, 5));
  ImageF alpha(120, 90, 1, float(h)), depth(120, 90, 1, float(h) * distance);
  const DepthMap map{&depth, &alpha};
  const RayQueries rays = rays_of(camera, one_node(60, 45), 3, 7, map);
  const bool from_map = h > 0.5;
  const float middle = (rays.near[0] + rays.far[0]) / 2;
  worst.ours_is(finite(rays) && (from_map ? middle < 6.5f : std::abs(middle - 7) < 1e-4f));
  worst.ours_is(rays_on_surface(camera, rays, map)[0] == (from_map || h < 1e-3));
  worst.naive_is(std::isfinite(depth.data[0] / alpha.data[0]));
}

HARD_CASE("geometry: bilinear samples are correct up to the border and clamped beyond it", "position, px",
          {0.5, 0, -1, -1e9, 1e9}, 0.84, {"floor and the four pixels around", test::kWrong}) {
  ImageF image(7, 5, 1);
  for (float& x : image.data) x = float(random.uniform(1, 2));
  const double y = random.uniform(0, 5), value = sample_bilinear(image, h, y);
  const BilinearAxis v = bilinear_axis(y, 5);
  const int column = h > 7 ? 6 : 0;
  const Real want = (1 - v.weight) * Real(image.at(column, v.lower)) + v.weight * Real(image.at(column, v.upper));
  worst.ours(float(value), want);
  const double left = std::floor(h - 0.5);
  worst.naive_is(left >= 0 && left + 1 < 7);
}

HARD_CASE("geometry: the radius of an object's core keeps its accuracy however far from the origin the core lies",
          "distance over radius", {1, 1e2, 1e4, 1e6}, 75, {"sqrt(E[x^2] - |centre|^2), in double", 1e14}, 20) {
  constexpr int kCount = 300;
  GaussianCloud cloud;
  cloud.resize(kCount, 0);
  LabelColumns object;
  object.prob.assign(kCount, 1.f);
  object.views.assign(kCount, 1.f);
  const std::vector<double> unit = random.uniform_vector<double>(kCount * 3 + 3, -1, 1);
  for (std::size_t i = 0; i < cloud.position.size(); ++i)
    cloud.position[i] = float(h * (2 + unit[kCount * 3 + i % 3]) + unit[i]);
  Real mean[3] = {0, 0, 0}, squares = 0;
  double naive_mean[3] = {0, 0, 0}, naive = 0;
  for (std::size_t i = 0; i < cloud.position.size(); ++i) {
    const double x = double(cloud.position[i]);
    mean[i % 3] += Real(x) / kCount;
    naive_mean[i % 3] += x / kCount;
    naive += x * x / kCount;
  }
  for (std::size_t i = 0; i < cloud.position.size(); ++i)
    squares += (Real(cloud.position[i]) - mean[i % 3]) * (Real(cloud.position[i]) - mean[i % 3]);
  for (const double m : naive_mean) naive -= m * m;
  const Real radius = std::sqrt(squares / kCount);
  worst.ours(core_of({}, cloud, std::span(&object, 1)).radius, radius);
  worst.naive(std::sqrt(std::max(0.0, naive)), radius);
}

}  // namespace ngs
