#pragma once
// Points of a mesh on a grid of integers, so that the side of a plane is exact and the same on every processor.
#include <cstdint>
#include <span>

#include "ngs/math/vec.h"
#include "ngs/scene/triangle_mesh.h"

namespace ngs::mesh {

/// Coordinates in [0, kGridCells]: determinants of three differences fit into 64 bits.
using GridPoint = Vec3<std::int64_t>;
inline Vec3<double> to_double(GridPoint p) { return {double(p.x), double(p.y), double(p.z)}; }
inline constexpr std::int64_t kGridCells = std::int64_t(1) << 20;

/// The cube around a mesh, its side kGridCells steps long.
class ExactGrid {
 public:
  /// Of no points, or of coincident ones, a step is 1 world unit. Throws kNumeric if a coordinate is not finite.
  explicit ExactGrid(std::span<const Vec3<float>> points);
  /// The nearest grid point: at most half a step away per axis.
  GridPoint of(Vec3<float> p) const;
  Vec3<double> world(GridPoint p) const { return low_ + step_ * to_double(p); }
  double step() const { return step_; }  ///< world

 private:
  Vec3<double> low_{};
  double step_ = 1;
};

/// 6 x the signed volume of the tetrahedron a, b, c, d: positive if d lies in front of a, b, c (counter-clockwise).
inline std::int64_t orient(GridPoint a, GridPoint b, GridPoint c, GridPoint d) {
  return dot(cross(b - a, c - a), d - a);
}

}  // namespace ngs::mesh
