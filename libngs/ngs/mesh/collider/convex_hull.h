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

/// The hull of `points`; with more than `max_vertices` (>= 4) corners, of the first that many, each the farthest point
/// outside the hull so far. Points that span no volume (fewer than 4, coplanar) have no faces and no vertices.
ConvexHull convex_hull(std::span<const GridPoint> points, std::size_t max_vertices);

/// The smallest box around a convex hull with one side on a face of it and another along an edge of that face's view.
struct OrientedBox {
  Vec3<double> centre{};               ///< grid steps
  std::array<Vec3<double>, 3> axes{};  ///< unit, right-handed
  Vec3<double> half{};                 ///< grid steps, along `axes`
};
/// `hull` has faces. The box holds all of its vertices but for rounding.
OrientedBox oriented_box(const ConvexHull& hull);

}  // namespace ngs::mesh
