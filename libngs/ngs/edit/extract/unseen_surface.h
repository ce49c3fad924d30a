#pragma once
// The surface of an object that is exposed by its extraction but visible in no view: the underside, the side to a wall.
// The splat is unreliable there: no photo constrains its Gaussians, or they are the inside of the opposite side.
#include "ngs/core/monitor.h"
#include "ngs/math/vectors.h"
#include "ngs/ops/splat/splat.h"

namespace ngs {

struct UnseenSurface {
  double share = 0;               // unseen fraction of the object's pixels in renders from all directions, in [0, 1]
  double worst = 0;               // this fraction in the direction where it is largest
  orbit::Vec direction{0, 0, 1};  // that direction, from the object to the camera, a unit vector of the world
};

struct UnseenInput {
  const GaussianCloud& cloud;               // the full model of the capture
  const std::vector<std::uint8_t>& object;  // [N] 1: of the extracted object
  const std::vector<Camera>& cameras;       // cameras of the capture
};

/// Renders the object alone from 96 directions spread evenly over the sphere, 96 px wide, framed on its bulk. The
/// surface point of an opaque pixel is seen if it projects into the image of a camera of the capture, its normal (from
/// the render's depths) faces this camera, and the full model's depth there is at most a tenth of the object's radius
/// smaller. The result is 0 if no pixel shows the object.
UnseenSurface unseen_surface(const Exec& exec, Monitor& monitor, const UnseenInput& input);

}  // namespace ngs
