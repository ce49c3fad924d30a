#include "ngs/ops/ray_query.h"

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/ray_query_kernels.h"
#include "ngs/ops/sample_grid.h"

namespace ngs {
namespace {

constexpr double kCovered = 0.5;        // alpha above which a pixel has a depth of its own
constexpr double kNothingThere = 1e-3;  // alpha below which the view shows only background

struct Node {
  Vec3<double> direction;
  double u, v, cosine;
};

Node node_at(const Camera& camera, const PixelGrid& grid, std::int64_t ray) {
  Node node;
  node.u = grid.x(int(ray % grid.cols)), node.v = grid.y(int(ray / grid.cols));
  node.direction =
      ray_direction(camera.rotation, camera.fx, camera.fy, camera.cx, camera.cy, node.u, node.v, node.cosine);
  return node;
}

/// Expected distance along the ray, or 0 where the view covers at most `least_alpha` of the pixel.
double expected_distance(const DepthMap& map, const Node& node, double least_alpha) {
  if (map.depth == nullptr || map.alpha == nullptr) return 0;
  const double alpha = sample_bilinear(*map.alpha, node.u, node.v);
  if (!(alpha > least_alpha)) return 0;
  return sample_bilinear(*map.depth, node.u, node.v) / alpha / node.cosine;
}

void store(float* p, Vec3<double> v) { p[0] = float(v.x), p[1] = float(v.y), p[2] = float(v.z); }

}  // namespace

RayQueries ray_queries(const Exec& exec, const Camera& camera, const PixelGrid& grid,
                       const RayOptions& options, const DepthMap& map) {
  NGS_CHECK(options.samples >= 1, "a ray has at least one sample");
  RayQueries out;
  out.grid = grid, out.samples = options.samples;
  const std::int64_t rays = grid.nodes();
  const auto count = std::size_t(rays), samples = std::size_t(options.samples);
  out.pixel.resize(count * 2), out.direction.resize(count * 3), out.near.resize(count), out.far.resize(count);
  out.spacing.resize(count), out.position.resize(count * samples * 3), out.depth.resize(count * samples);
  const Vec3<double> centre = camera.centre();
  for_each_index(exec, rays, [&](std::int64_t ray) {
    const auto r = std::size_t(ray);
    const Node node = node_at(camera, grid, ray);
    double distance = expected_distance(map, node, kCovered);
    if (!(distance > kNearZ)) distance = options.mean_distance;
    const DepthWindow<double> window =
        depth_window(distance, options.depth_span, options.depth_epsilon, kNearZ / node.cosine);
    out.pixel[r * 2] = float(node.u), out.pixel[r * 2 + 1] = float(node.v);
    store(&out.direction[r * 3], node.direction);
    out.near[r] = float(window.near), out.far[r] = float(window.far);
    out.spacing[r] = float(sample_spacing(window, options.samples));
    for (std::size_t k = 0; k < samples; ++k) {
      const double t = sample_distance(window, int(k), options.samples);
      out.depth[r * samples + k] = float(t);
      store(&out.position[(r * samples + k) * 3], centre + t * node.direction);
    }
  });
  return out;
}

std::vector<std::uint8_t> rays_on_surface(const Camera& camera, const RayQueries& rays, const DepthMap& map) {
  std::vector<std::uint8_t> on(std::size_t(rays.rays()), 1);
  for (std::size_t r = 0; r < on.size(); ++r) {
    const double distance =
        expected_distance(map, node_at(camera, rays.grid, std::int64_t(r)), kNothingThere);
    on[r] = distance == 0 || (distance >= double(rays.near[r]) && distance <= double(rays.far[r]));
  }
  return on;
}

double sample_bilinear(const ImageF& image, double x_px, double y_px, int c) {
  const BilinearAxis x = bilinear_axis(x_px, image.width_px), y = bilinear_axis(y_px, image.height_px);
  const auto row = [&](int at) {
    return (1 - x.weight) * double(image.at(x.lower, at, c)) + x.weight * double(image.at(x.upper, at, c));
  };
  return (1 - y.weight) * row(y.lower) + y.weight * row(y.upper);
}

}  // namespace ngs
