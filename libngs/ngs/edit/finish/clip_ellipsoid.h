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

/// Number of standard deviations at which an opaque Gaussian has an alpha of 1/2: its outline in a mask. Parts farther
/// out are neither tested nor clipped.
inline constexpr double kOutline = 1.2;

enum class Clip { kWithin, kClipped, kUnsupported };

/// Tests points of the Gaussian: its centre, points at the outline and half-way to it on each axis longer than `least`
/// (world), and diagonals between the two longest such axes. If a point is unsupported, these axes are clipped, the
/// longest first. An axis keeps the supported interval nearest to the centre: the centre moves to its middle, and the
/// standard deviation shrinks so that the outline ends with the interval. No axis grows.
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

/// Clips a Gaussian whose outline crosses the plane. The Gaussian is shortened along the direction conjugate to the
/// plane until its outline only touches the plane; its extent parallel to the plane stays. Axes and standard deviations
/// are those of the new covariance, in any order. kUnsupported: less than 1/64 of the extent is in front. kWithin: the
/// Gaussian is in front, or a value is not finite. In both cases `shape` is unchanged.
Clip clip_half_space(const HalfSpace& side, Ellipsoid& shape);

}  // namespace ngs::finish
