#pragma once
// Scalar maths of the boundary's box in a view and of the grid over it.                    Eqs. (4)-(5)
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/pixel_grid.h"
#include "ngs/math/stable.h"
#include "ngs/math/vec.h"

namespace ngs {

/// Gaussians nearer than this (camera z, units of math/world_unit.h) are ignored: their projection is not meaningful.
inline constexpr double kNearZ = 0.01;

/// A camera in the form that kernels take.
struct RayCamera {
  Mat3<double> rotation;  // world -> camera
  Vec3<double> translation, centre;
  double fx, fy, cx, cy;  // px
  int width_px, height_px;
  double near_z = kNearZ;  // camera z, world
};

/// Box and sums over the boundary Gaussians in front of the camera that project into the padded image.
struct BoxSums {
  PixelBox box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};  // of the centres
  double distance_sum = 0;
  std::int64_t visible = 0;

  NGS_HD void add(const RayCamera& camera, Vec3<double> world, double pad_px) {
    const Vec3<double> t = camera.rotation * world + camera.translation;
    if (!(t.z > camera.near_z)) return;
    const double x = camera.fx * t.x / t.z + camera.cx, y = camera.fy * t.y / t.z + camera.cy;
    if (!(x >= -pad_px && x <= camera.width_px + pad_px && y >= -pad_px && y <= camera.height_px + pad_px)) return;
    const Vec3<double> away = world - camera.centre;
    add(BoxSums{{x, y, x, y}, std::sqrt(dot(away, away)), 1});
  }
  NGS_HD void add(const BoxSums& o) {
    box = {min2(box.min_x, o.box.min_x), min2(box.min_y, o.box.min_y), max2(box.max_x, o.box.max_x),
           max2(box.max_y, o.box.max_y)};
    distance_sum += o.distance_sum;
    visible += o.visible;
  }
};

struct BoundaryBox {
  PixelBox box;              // clipped to the image; empty (all 0) if visible == 0
  std::int64_t visible = 0;  // boundary Gaussians in front of the camera that project into the padded image
  double mean_distance = 0;  // world, Euclidean, from the camera centre, over the visible ones (C12)
};

NGS_HD inline BoundaryBox boundary_box(const RayCamera& camera, const BoxSums& sums, double pad_px) {
  if (sums.visible == 0) return {};
  const PixelBox& b = sums.box;
  return {{max2(b.min_x - pad_px, 0.0), max2(b.min_y - pad_px, 0.0), min2(b.max_x + pad_px, double(camera.width_px)),
           min2(b.max_y + pad_px, double(camera.height_px))},
          sums.visible,
          sums.distance_sum / double(sums.visible)};
}

/// Largest number of cells; their nodes are their middles (C7).
struct GridShape {
  int rows, cols;
};

/// At most rows x cols cells over the box, fewer where they would be smaller than 1 px.         Eq. (5)
/// A box thinner than 1 px has one node on that axis, in its middle; an empty box has no nodes.
NGS_HD inline PixelGrid pixel_grid(const PixelBox& box, const GridShape& shape) {
  struct Axis {
    double first, step;
    int count;
    double beyond;
  };
  const auto axis = [&](double low, double high, int cells) -> Axis {
    const double length = high - low;
    if (length < 1) return {(low + high) / 2, 1, 1, length / 2};
    const int fitting = int(min2(double(cells), std::floor(length)));
    const double step = length / fitting;
    return {low + step / 2, step, fitting, step / 2};
  };
  if (!(box.max_x > box.min_x) || !(box.max_y > box.min_y)) return {};
  const Axis x = axis(box.min_x, box.max_x, shape.cols), y = axis(box.min_y, box.max_y, shape.rows);
  return {x.first, y.first, x.step, y.step, x.count, y.count, x.beyond, y.beyond};
}

}  // namespace ngs
