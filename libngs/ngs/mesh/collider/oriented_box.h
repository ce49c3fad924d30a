#pragma once
// The smallest box around a convex hull that has one side on a face of it and another along an edge of that face's
// view.
#include "ngs/mesh/collider/convex_hull.h"

namespace ngs::mesh {

struct OrientedBox {
  Vec3<double> centre{};               ///< grid steps
  std::array<Vec3<double>, 3> axes{};  ///< unit, right-handed
  Vec3<double> half{};                 ///< grid steps, along `axes`
};
/// `hull` has faces. The box holds all of its vertices but for rounding.
OrientedBox oriented_box(const ConvexHull& hull);

}  // namespace ngs::mesh
