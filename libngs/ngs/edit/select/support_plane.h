#pragma once
// The plane that supports an object: a floor, a table top, the top of a pedestal.
//
// Directions around `up` are tried one by one. For each, a histogram of the Gaussians' heights is built, weighted by
// area and by how well a Gaussian's disc aligns with the plane: the sides of a pedestal are as large as its top, but
// their discs are upright. The best slab is then refitted by least squares, iteratively, with a tolerance that shrinks
// to three standard deviations of the Gaussians in it.
#include "ngs/scene/geometry/frame.h"

namespace ngs {

struct SupportPlane {
  bool found = false;
  orbit::Vec normal{0, 0, 1};  // world, unit length, towards the object
  double offset = 0;           // world, relative to the model's origin: normal · p = offset on the plane
  double thickness = 0;        // world: Gaussians up to this height above the plane belong to it
  double support = 0;          // fraction of the flat area (Gaussians aligned with the plane) in it, in [0, 1]
};

/// `points`: rows of `cloud` in canonical order (clusters.h). `up`: unit length, accurate to 25 degrees. found
/// is false without points, if all are at one position, or if no slab contains 1/20 of the flat area with at least
/// 1/100 of all area above it. Gaussians with object[row] != 0 may lie above the plane, but not support.
SupportPlane find_support_plane(const GaussianCloud& cloud, const orbit::SurfacePoints& points, orbit::Vec up,
                                const std::vector<std::uint8_t>& object = {});

/// Whether a found plane can support objects, that is, whether it is not a side of a body or a slice through it:
///   - At least a fifth of its surface has nothing close above. The back of a guitar has the front above it everywhere.
///   - If more than a tenth of the area lies below it, as below the top of a pedestal, it is thinner than 0.9 of the
///     tolerance of the first fit. A slice through shoulders is thicker.
bool supports_object(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const SupportPlane& plane);

/// Refits a plane that was found from some of `points` to all of them: the former may lie on one side of the object and
/// leave the tilt undetermined. Returns `plane` if it was not found, or if the fit tilts it by over 25 degrees.
SupportPlane refined_by(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const SupportPlane& plane);

/// Clears object[row] for Gaussians in the plane that supports the object, such as the floor under a rug, which masks
/// of the rug cover too. Position and thickness of the plane come from the Gaussians with object[row] == 0; Gaussians
/// just above and below it stay. Without a plane nothing changes.
void remove_support(const GaussianCloud& cloud, orbit::Vec up, std::vector<std::uint8_t>& object);

}  // namespace ngs
