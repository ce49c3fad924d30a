#pragma once
// Clips the ellipsoid of a Gaussian to one side of a plane.
#include "ngs/edit/finish/clip_ellipsoid.h"

namespace ngs::finish {

/// The side dot(normal, p) >= offset. The normal has length 1. `outline`: where a Gaussian ends, standard deviations.
struct HalfSpace {
  Vec3<double> normal{0, 0, 1};
  double offset = 0, outline = kOutline;
};

/// The point of the Gaussian's outline that is farthest behind the plane; the centre if all standard deviations are 0.
Vec3<double> lowest_point(const HalfSpace& side, const Ellipsoid& shape);

/// Clips a Gaussian whose outline crosses the plane: along its direction conjugate to the plane it becomes so short
/// that the outline ends at the plane, and its centre moves with it. Directions in the plane keep their extent; axes
/// and standard deviations are those of the new covariance, in any order. kUnsupported: less than 1/64 of the extent is
/// in front, `shape` is unchanged. kWithin: it is in front, or a value is not finite; `shape` is unchanged.
Clip clip_half_space(const HalfSpace& side, Ellipsoid& shape);

}  // namespace ngs::finish
