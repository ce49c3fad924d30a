#pragma once
// The world point that a pixel shows at a depth.
#include "ngs/scene/camera.h"

namespace ngs {

/// The inverse of Camera::project(): (x, y) in px, `z` > 0 the depth along the optical axis, world.
inline Vec3<double> unproject(const Camera& camera, double x, double y, double z) {
  const Vec3<double> local{z * (x - camera.cx) / camera.fx, z * (y - camera.cy) / camera.fy, z};
  return transpose(camera.rotation) * (local - camera.translation);
}

}  // namespace ngs
