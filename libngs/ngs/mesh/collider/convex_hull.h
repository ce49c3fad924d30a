#pragma once
// The convex hull of points on the exact grid (Barber, Dobkin and Huhdanpaa, quickhull), farthest point first.
//
// The side of every plane is exact, so there is no tolerance, and ties are broken by the lower index: the result
// depends on nothing but the points and their order.
#include <array>
#include <vector>

#include "ngs/mesh/collider/exact_grid.h"

namespace ngs::mesh {

struct ConvexHull {
  std::vector<GridPoint> vertices;                  ///< [V]; each is one of the points
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< [F], counter-clockwise seen from outside; coplanar ones occur
  double volume = 0;                                ///< grid steps^3
};

/// The hull of `points`, built by adding the point farthest outside until none is left or it has `max_vertices` (>= 4).
/// Points that span no volume (fewer than 4, coplanar) have no faces and no vertices.
ConvexHull convex_hull(std::span<const GridPoint> points, std::size_t max_vertices);

/// The smallest box around a hull, of boxes with a side on a hull face and another side along a projected hull edge.
struct OrientedBox {
  Vec3<double> centre{};               ///< grid steps
  std::array<Vec3<double>, 3> axes{};  ///< unit, right-handed
  Vec3<double> half{};                 ///< grid steps, along `axes`
};
/// `hull` must have faces. The box contains all its vertices, except for rounding.
OrientedBox oriented_box(const ConvexHull& hull);

}  // namespace ngs::mesh
