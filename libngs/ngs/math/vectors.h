#pragma once
// Vector algebra for placing cameras.
#include <cmath>
#include <vector>

#include "ngs/math/vec.h"

namespace ngs::orbit {

using Vec = Vec3<double>;

/// A unit vector perpendicular to the unit vector `v`.
inline Vec perpendicular(Vec v) {
  const bool x_is_least = std::abs(v.x) <= std::abs(v.y) && std::abs(v.x) <= std::abs(v.z);
  const Vec other = x_is_least ? Vec{1, 0, 0} : std::abs(v.y) <= std::abs(v.z) ? Vec{0, 1, 0} : Vec{0, 0, 1};
  return unit(cross(v, other));
}

/// `count` directions spread evenly over the unit sphere (a Fibonacci spiral around +z), from +z down.
inline std::vector<Vec> even_directions(int count) {
  constexpr double kGoldenAngle = 2.39996322972865332;  // rad
  std::vector<Vec> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, radius = std::sqrt(1 - z * z), angle = kGoldenAngle * i;
    directions.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
  }
  return directions;
}

}  // namespace ngs::orbit
