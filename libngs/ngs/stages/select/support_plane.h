#pragma once
// The plane that an object stands on: a floor, a table top, the top of a pedestal.
//
// Directions about that of up are tried one by one. In each the heights of the Gaussians are counted, every one with
// the area that it shows, and those that lie flat in the plane count most: the sides of a pedestal are as large as its
// top, but their Gaussians stand upright. The best slab is then fitted by least squares, again and again, with a
// tolerance that shrinks to three standard deviations of what lies in it.
#include "ngs/stages/orbit/frame.h"

namespace ngs {

struct SupportPlane {
  bool found = false;
  orbit::Vec normal{0, 0, 1};  // world, unit length, towards the object
  double offset = 0;           // world, relative to the model's origin: normal · p = offset on the plane
  double thickness = 0;        // world: Gaussians no higher than this above it are of what lies in the plane
  double support = 0;          // share of what lies flat that lies in it, in [0, 1]
};

/// `points` in an order of their own (canonical_points.h), rows of `cloud`; `up` of unit length, right within 25
/// degrees. found = false where there are no points, all are at one place, or no slab that has a hundredth of all
/// above it holds a twentieth of what lies flat.
SupportPlane find_support_plane(const GaussianCloud& cloud, const orbit::SurfacePoints& points, orbit::Vec up);

/// Whether a found plane is one that things stand on, not a side of a body or a slice of it. A fifth of its surface has
/// nothing close above it: the back of a guitar has the front above it everywhere. And where a tenth of all lies below
/// it, as below the top of a pedestal, it is thinner than the tolerance of the first fit: a slice through shoulders is
/// not.
bool is_stood_on(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const SupportPlane& plane);

/// A plane that was found by some of `points`, fitted to all of them: those that found it may lie to one side of what
/// stands on it, and leave its tilt open. As it is where it was not found, or where the fit would tilt it by more than
/// 25 degrees.
SupportPlane refined_by(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const SupportPlane& plane);

}  // namespace ngs
