#pragma once
// Clips the ellipsoid of a Gaussian to the part of space that views support.
#include <functional>

#include "ngs/math/vec.h"

namespace ngs::finish {

/// The shape of a Gaussian: centre, axes as columns (orthonormal), standard deviations. World.
struct Ellipsoid {
  Vec3<double> centre{};
  Mat3<double> axes{};
  double sigma[3] = {};
};

using Supported = std::function<bool(Vec3<double>)>;

/// An opaque Gaussian is half transparent at this number of standard deviations: its outline in a mask. What lies
/// farther out is neither tested nor clipped.
inline constexpr double kOutline = 1.2;

enum class Clip { kWithin, kClipped, kUnsupported };

/// Tests the centre, and on every axis whose outline is farther than `least` (world) from the centre points at the
/// outline and half-way to it, and the diagonals between the two longest such axes. If one is unsupported, every axis
/// from the longest to the shortest is clipped to the supported interval nearest to the centre: the centre moves to its
/// middle, and the standard deviation shrinks so that the outline ends with the interval. No axis grows.
///
/// kWithin: `shape` is unchanged. kUnsupported: no tested point is supported, `shape` is unchanged. `outline`: in
/// standard deviations.
Clip clip_ellipsoid(double least, const Supported& supported, Ellipsoid& shape, double outline = kOutline);

// Clips the ellipsoid of a Gaussian to one side of a plane.

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
