#pragma once
// Pinhole camera. Camera axes: +x right, +y down, +z forward (COLMAP, 3DGS). The centre of pixel (i, j) is at
// (i + 0.5, j + 0.5); cx, cy follow the same convention.
#include <array>
#include <cmath>
#include <string>

#include "ngs/math/vec.h"

namespace ngs {

struct Camera {
  std::string name;  // image file name as spelled in the source, e.g. "0001.png"
  int width_px = 0, height_px = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;  // px; the principal point may be off-centre
  Mat3<double> rotation{};                // world -> camera, orthonormal, det +1
  Vec3<double> translation{};             // world -> camera: x_cam = R x_world + t

  /// Camera centre in world coordinates: -Rᵀ t.
  Vec3<double> centre() const { return -1.0 * (transpose(rotation) * translation); }
};

/// The camera of the same pose for an image resized to width x height.
inline Camera resized(Camera camera, int width_px, int height_px) {
  const double sx = double(width_px) / camera.width_px, sy = double(height_px) / camera.height_px;
  camera.fx *= sx, camera.cx *= sx, camera.fy *= sy, camera.cy *= sy;
  camera.width_px = width_px, camera.height_px = height_px;
  return camera;
}

/// The camera for coordinates relative to `origin` (GaussianCloud::origin): x_world = origin + x.
inline Camera relative_to(Camera camera, const std::array<double, 3>& origin) {
  camera.translation = camera.translation + camera.rotation * Vec3<double>{origin[0], origin[1], origin[2]};
  return camera;
}

/// The size of one side after `--image-scale`: rounded to nearest, at least 1 px.
inline int scaled_size_px(int size_px, double scale) {
  const int rounded = int(std::lround(size_px * scale));
  return rounded < 1 ? 1 : rounded;
}

}  // namespace ngs
