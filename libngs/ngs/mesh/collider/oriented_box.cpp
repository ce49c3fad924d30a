#include "ngs/mesh/collider/oriented_box.h"

#include <algorithm>
#include <limits>

namespace ngs::mesh {
namespace {

constexpr std::size_t kFaceCorners = 64;  // of the coarser hull that gives the directions

OrientedBox box_along(const ConvexHull& hull, const std::array<Vec3<double>, 3>& axes) {
  OrientedBox box{{}, axes, {}};
  std::array<double, 3> half{};
  for (std::size_t k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const GridPoint& p : hull.vertices) {
      low = std::min(low, dot(axes[k], to_double(p)));
      high = std::max(high, dot(axes[k], to_double(p)));
    }
    half[k] = (high - low) / 2;
    box.centre = box.centre + ((low + high) / 2) * axes[k];
  }
  box.half = {half[0], half[1], half[2]};
  return box;
}

double volume_of(const OrientedBox& box) { return 8 * box.half.x * box.half.y * box.half.z; }

}  // namespace

OrientedBox oriented_box(const ConvexHull& hull) {
  const ConvexHull coarse = convex_hull(hull.vertices, kFaceCorners);
  OrientedBox best = box_along(hull, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  double least = volume_of(box_along(coarse, best.axes));
  std::array<Vec3<double>, 3> axes = best.axes;
  for (const auto& [a, b, c] : coarse.faces) {
    const Vec3<double> from = to_double(coarse.vertices[a]);
    const Vec3<double> up = unit(cross(to_double(coarse.vertices[b]) - from, to_double(coarse.vertices[c]) - from));
    for (const auto& edge : coarse.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        if (edge[k] > edge[(k + 1) % 3]) continue;  // each edge once
        const Vec3<double> along = to_double(coarse.vertices[edge[(k + 1) % 3]]) - to_double(coarse.vertices[edge[k]]);
        const Vec3<double> flat = along - dot(along, up) * up;
        if (dot(flat, flat) <= 1e-6 * dot(along, along)) continue;  // seen end on
        const Vec3<double> x = unit(flat);
        const OrientedBox box = box_along(coarse, {x, cross(up, x), up});
        if (volume_of(box) >= least) continue;
        least = volume_of(box);
        axes = box.axes;
      }
  }
  const OrientedBox turned = box_along(hull, axes);
  return volume_of(turned) < volume_of(best) ? turned : best;
}

}  // namespace ngs::mesh
