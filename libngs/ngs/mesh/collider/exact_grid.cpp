#include "ngs/mesh/collider/exact_grid.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"

namespace ngs::mesh {

ExactGrid::ExactGrid(std::span<const Vec3<float>> points) {
  if (points.empty()) return;
  Vec3<double> high{points[0].x, points[0].y, points[0].z};
  low_ = high;
  for (const Vec3<float>& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(ErrorCode::kNumeric, "mesh: a vertex is not finite, expected finite coordinates",
                  "remove the vertex, or make the mesh again");
    low_ = {std::min<double>(low_.x, p.x), std::min<double>(low_.y, p.y), std::min<double>(low_.z, p.z)};
    high = {std::max<double>(high.x, p.x), std::max<double>(high.y, p.y), std::max<double>(high.z, p.z)};
  }
  const double side = std::max({high.x - low_.x, high.y - low_.y, high.z - low_.z});
  if (side > 0) step_ = side / double(kGridCells);
}

GridPoint ExactGrid::of(Vec3<float> p) const {
  const auto along = [this](double x, double low) {
    return std::clamp<std::int64_t>(std::llround((x - low) / step_), 0, kGridCells);
  };
  return {along(p.x, low_.x), along(p.y, low_.y), along(p.z, low_.z)};
}

}  // namespace ngs::mesh
