#pragma once
// Pinhole camera. Camera axes: +x right, +y down, +z forward (COLMAP, 3DGS). The centre of pixel (i, j) is at
// (i + 0.5, j + 0.5); cx, cy follow the same convention.
#include <array>
#include <cmath>
#include <optional>
#include <span>
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
  /// From world to camera axes.
  Vec3<double> to_camera(Vec3<double> world) const { return rotation * world + translation; }
  /// The pixel (x, y) that shows a world point, and its depth z > 0; nullopt behind the camera and outside the image.
  std::optional<Vec3<double>> project(Vec3<double> world) const {
    const Vec3<double> at = to_camera(world);
    if (!(at.z > 0)) return std::nullopt;
    const double x = fx * at.x / at.z + cx, y = fy * at.y / at.z + cy;
    if (!(x >= 0 && y >= 0 && x < width_px && y < height_px)) return std::nullopt;
    return Vec3<double>{x, y, at.z};
  }
};

/// The camera of the same pose for an image resized to width x height.
inline Camera resized(Camera camera, int width_px, int height_px) {
  const double sx = double(width_px) / camera.width_px, sy = double(height_px) / camera.height_px;
  camera.fx *= sx;
  camera.cx *= sx;
  camera.fy *= sy;
  camera.cy *= sy;
  camera.width_px = width_px;
  camera.height_px = height_px;
  return camera;
}

/// The camera for coordinates relative to `origin` (GaussianCloud::origin): x_world = origin + x.
inline Camera relative_to(Camera camera, const std::array<double, 3>& origin) {
  camera.translation = camera.translation + camera.rotation * Vec3<double>{origin[0], origin[1], origin[2]};
  return camera;
}

/// Pulls towards the point `ahead` in front of each camera, world, for axes that are nearly parallel.
struct AxisRegulariser {
  double weight = 0, ahead = 0;
};

/// The point nearest to the optical axes of all cameras; nullopt if all axes are parallel and nothing pulls.
inline std::optional<Vec3<double>> point_nearest_to_axes(std::span<const Camera> cameras, AxisRegulariser pull = {}) {
  // Σ (1 + w - aaᵀ) x = rhs, solved by Cramer's rule
  Vec3<double> row[3] = {}, rhs{0, 0, 0};
  const Vec3<double> basis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Camera& camera : cameras) {
    const Mat3<double>& r = camera.rotation;
    const Vec3<double> axis{r(2, 0), r(2, 1), r(2, 2)}, centre = camera.centre();
    for (int k = 0; k < 3; ++k) row[k] = row[k] + (1 + pull.weight) * basis[k] - dot(axis, basis[k]) * axis;
    rhs = rhs + centre - dot(axis, centre) * axis + pull.weight * (centre + pull.ahead * axis);
  }
  const Vec3<double> c0 = cross(row[1], row[2]), c1 = cross(row[2], row[0]), c2 = cross(row[0], row[1]);
  const double determinant = dot(row[0], c0), n = double(cameras.size());
  if (!(determinant > 1e-9 * n * n * n)) return std::nullopt;
  return (1 / determinant) * (rhs.x * c0 + rhs.y * c1 + rhs.z * c2);
}

/// The size of one side after `--image-scale`: rounded to nearest, at least 1 px.
inline int scaled_size_px(int size_px, double scale) {
  const int rounded = int(std::lround(size_px * scale));
  return rounded < 1 ? 1 : rounded;
}

}  // namespace ngs
