#include "ngs/ops/sample_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ngs {
namespace {

struct Axis {
  double first, step;
  int count;
};

Axis axis_nodes(double low, double high, int cells, GridNodes nodes) {
  const double length = high - low;
  if (length < 1) return {(low + high) / 2, 1, 1};
  const int fitting = int(std::min(double(cells), std::floor(length)));
  const double step = length / fitting;
  if (nodes == GridNodes::kInclusive) return {low, step, fitting + 1};
  return {low + step / 2, step, fitting};
}

}  // namespace

BoundaryBox boundary_box(const Camera& camera, Rows<const float, 3> boundary, double pad_px) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  BoundaryBox result;
  PixelBox box{kInfinity, kInfinity, -kInfinity, -kInfinity};
  const Vec3<double> centre = camera.centre();
  double distance_sum = 0;
  for (std::int64_t j = 0; j < boundary.n; ++j) {
    const float* p = boundary.row(j);
    const Vec3<double> world{p[0], p[1], p[2]}, t = camera.rotation * world + camera.translation;
    if (!(t.z > kNearZ)) continue;
    const double x = camera.fx * t.x / t.z + camera.cx, y = camera.fy * t.y / t.z + camera.cy;
    const bool inside =
        x >= -pad_px && x <= camera.width_px + pad_px && y >= -pad_px && y <= camera.height_px + pad_px;
    if (!inside) continue;
    ++result.visible;
    distance_sum += std::sqrt(dot(world - centre, world - centre));
    box = {std::min(box.min_x, x), std::min(box.min_y, y), std::max(box.max_x, x), std::max(box.max_y, y)};
  }
  if (result.visible == 0) return result;
  result.mean_distance = distance_sum / double(result.visible);
  result.box = {std::max(box.min_x - pad_px, 0.0), std::max(box.min_y - pad_px, 0.0),
                std::min(box.max_x + pad_px, double(camera.width_px)),
                std::min(box.max_y + pad_px, double(camera.height_px))};
  return result;
}

PixelGrid pixel_grid(const PixelBox& box, int rows, int cols, GridNodes nodes) {
  if (!(box.max_x > box.min_x) || !(box.max_y > box.min_y)) return {};
  const Axis x = axis_nodes(box.min_x, box.max_x, cols, nodes),
             y = axis_nodes(box.min_y, box.max_y, rows, nodes);
  return {x.first, y.first, x.step, y.step, x.count, y.count};
}

}  // namespace ngs
