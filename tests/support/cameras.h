#pragma once
// Cameras for tests: general rotations, non-square pixels, principal points off centre.
#include <cmath>

#include "ngs/scene/camera.h"
#include "support/random.h"

namespace ngs::test {

/// A camera at `distance` from the origin looking at it along a random direction.
inline Camera camera_around(Random& random, double distance, int width_px = 120, int height_px = 90) {
  const double z = random.uniform(-0.9, 0.9), phi = random.uniform(0, 6.28), r = std::sqrt(1 - z * z);
  const Vec3<double> forward{-r * std::cos(phi), -r * std::sin(phi), -z};
  const Vec3<double> side = cross(Vec3<double>{0, 0, 1}, forward);
  const Vec3<double> right = (1 / std::sqrt(dot(side, side))) * side, down = cross(forward, right);
  Camera camera{"test.png", width_px, height_px, 1.1 * width_px, 1.2 * width_px, 0.47 * width_px, 0.55 * height_px};
  camera.rotation = {{right.x, right.y, right.z, down.x, down.y, down.z, forward.x, forward.y, forward.z}};
  camera.translation = {0, 0, distance};
  return camera;
}

/// At the origin, looking along +z; the principal point is the middle of the image.
inline Camera camera_along_z(int width_px, int height_px, double focal_px) {
  Camera camera{"test.png", width_px, height_px, focal_px, focal_px, 0.5 * width_px, 0.5 * height_px};
  camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  return camera;
}

inline Vec2<double> project(const Camera& camera, Vec3<double> world) {
  const Vec3<double> t = camera.rotation * world + camera.translation;
  return {camera.fx * t.x / t.z + camera.cx, camera.fy * t.y / t.z + camera.cy};
}

}  // namespace ngs::test
