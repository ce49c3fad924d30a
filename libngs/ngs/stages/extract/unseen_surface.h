#pragma once
// What of an object shows once its surroundings are gone, and no view has seen: the underside, the side to a wall.
// A splat says nothing reliable there: what stands there was fitted to nothing, or is the inside of the other side.
#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/stages/orbit/vectors.h"

namespace ngs {

struct UnseenSurface {
  double share = 0;               // of the object's pixels in pictures from all around, in [0, 1]
  double worst = 0;               // the share from the direction where it is largest
  orbit::Vec direction{0, 0, 1};  // that direction, from the object to who looks, a unit vector of the world
};

struct UnseenInput {
  const GaussianCloud& cloud;               // the whole model, as it was captured
  const std::vector<std::uint8_t>& object;  // [N] 1: taken out
  const std::vector<Camera>& cameras;       // of the capture
};

/// The object alone is drawn from 96 directions spread evenly over the sphere, each picture 96 px wide and as near as
/// shows its bulk. The point that an opaque pixel shows is seen if a camera of the capture looks at this side of the
/// surface (by the picture's own depths), has it in its picture, and the whole model's depth there is at most a tenth
/// of the object's radius nearer. An object of which nothing is drawn has no unseen surface.
UnseenSurface unseen_surface(const Exec& exec, Monitor& monitor, const UnseenInput& input);

}  // namespace ngs
