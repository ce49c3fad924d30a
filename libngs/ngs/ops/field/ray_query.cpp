#include "ngs/ops/field/ray_query.h"

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/field/sample_grid.h"

namespace ngs {
namespace {

/// The map of a grid's rays, without copies of images from a device.
struct MapOfGrid {
  std::vector<NodeDepth> node;
  DepthPlanes planes;

  MapOfGrid(const DepthMap& map, const RayCamera& camera, const PixelGrid& grid) {
    if (map.depth == nullptr || map.alpha == nullptr) return;
    planes = {map.depth->data.data(), map.alpha->data.data(), map.alpha->width_px, map.alpha->height_px};
    if (map.device == nullptr || map.device->device_ops == nullptr) return;
    node.resize(std::size_t(grid.nodes()));
    map.device->device_ops->field.read_nodes({camera, grid, planes, node.data()});
    planes = {.node = node.data()};
  }
};

}  // namespace

RayQueries ray_queries(const Exec& exec, const Camera& camera, const PixelGrid& grid, const RayOptions& options,
                       const DepthMap& map) {
  NGS_CHECK(options.samples >= 1, "a ray has at least one sample");
  RayQueries out;
  out.grid = grid;
  out.samples = options.samples;
  const std::int64_t rays = grid.nodes();
  const auto count = std::size_t(rays), samples = std::size_t(options.samples);
  out.pixel.resize(count * 2);
  out.direction.resize(count * 3);
  out.near.resize(count);
  out.far.resize(count);
  out.spacing.resize(count);
  out.position.resize(count * samples * 3);
  out.depth.resize(count * samples);
  const RayArrays arrays{out.pixel.data(),   out.direction.data(), out.near.data(), out.far.data(),
                         out.spacing.data(), out.position.data(),  out.depth.data()};
  const MapOfGrid of_grid(map, ray_camera(camera), grid);
  for_each_index(exec, rays, SampleRay{ray_camera(camera), grid, options, of_grid.planes, arrays});
  return out;
}

std::vector<std::uint8_t> rays_on_surface(const Camera& camera, const RayQueries& rays, const DepthMap& map) {
  std::vector<std::uint8_t> on(std::size_t(rays.rays()), 1);
  const MapOfGrid of_grid(map, ray_camera(camera), rays.grid);
  const RayOnSurface kernel{ray_camera(camera), rays.grid,       of_grid.planes,
                            rays.near.data(),   rays.far.data(), on.data()};
  for (std::int64_t r = 0; r < rays.rays(); ++r) kernel(r);
  return on;
}

double sample_bilinear(const ImageF& image, double x_px, double y_px, int c) {
  return read_bilinear(x_px, y_px, image.width_px, image.height_px, [&](int x, int y) { return image.at(x, y, c); });
}

}  // namespace ngs
