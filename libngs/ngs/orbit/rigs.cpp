#include "ngs/orbit/rigs.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace ngs::orbit {
namespace {

constexpr double kRadian = std::numbers::pi / 180;
constexpr double kStops = 0.35;        // optical depth at which a line of sight counts as blocked
constexpr double kNearestShare = 0.6;  // least distance, as a fraction of the full distance
constexpr double kMargin = 1.04;       // scale of the full distance, for a margin around the ball in the image

Vec direction(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

/// Distance from the ball's centre up to which lines of sight along `out` are free: the second shortest of seven.
double free_distance(const FreeSpace& space, double radius, Vec out, double max_length) {
  const Vec a = perpendicular(out), b = cross(out, a);
  std::array<double, 7> reach{};
  for (int k = 0; k < 7; ++k) {
    const double turn = std::numbers::pi / 3 * k, off = k == 6 ? 0 : 0.6 * radius;
    const double start = std::sqrt(radius * radius - off * off);
    const Vec from = start * out + (off * std::cos(turn)) * a + (off * std::sin(turn)) * b;
    reach[std::size_t(k)] = start + space.free_length(from, out, {kStops, max_length - start});
  }
  std::sort(reach.begin(), reach.end());
  return reach[1];
}

/// `count` poses at one elevation; poses without free space are left out.
struct Ring {
  double elevation, phase;  // rad; fraction of a step
  int count;
};

}  // namespace

double Intrinsics::focal_px() const { return 0.5 * std::max(width_px, height_px) / std::tan(0.5 * fov_deg * kRadian); }

double Intrinsics::least_half_sine() const {
  return std::sin(std::atan(0.5 * std::min(width_px, height_px) / focal_px()));
}

Camera camera_at(const Pose& pose, const Intrinsics& intrinsics, const Frame& frame,
                 const std::array<double, 3>& origin) {
  const Vec forward = unit(pose.target - pose.centre);
  const bool along_z = std::abs(forward.z) > 0.999;
  const Vec right = unit(cross(forward, along_z ? Vec{1, 0, 0} : Vec{0, 0, 1})), down = cross(forward, right);
  const Mat3<double> in_frame{{right.x, right.y, right.z, down.x, down.y, down.z, forward.x, forward.y, forward.z}};
  Camera camera;
  camera.width_px = intrinsics.width_px;
  camera.height_px = intrinsics.height_px;
  camera.fx = camera.fy = intrinsics.focal_px();
  camera.cx = 0.5 * intrinsics.width_px;
  camera.cy = 0.5 * intrinsics.height_px;
  camera.rotation = in_frame * frame.axes;
  const Vec world = frame.to_world(pose.centre) + Vec{origin[0], origin[1], origin[2]};
  camera.translation = -1.0 * (camera.rotation * world);
  return camera;
}

Rig rings_about(double radius, const Intrinsics& intrinsics, const FreeSpace& space, int views) {
  const double wanted = kMargin * radius / intrinsics.least_half_sine();
  Rig rig;
  const auto add = [&](const Ring& ring) {
    for (int k = 0; k < ring.count; ++k) {
      const Vec out = direction(2 * std::numbers::pi * (k + ring.phase) / ring.count, ring.elevation);
      const double free = free_distance(space, radius, out, wanted + 0.1 * radius) - 0.1 * radius;
      if (free >= kNearestShare * wanted) rig.poses.push_back({std::min(free, wanted) * out, {0, 0, 0}});
    }
  };
  const int low = std::max(1, int(std::lround(0.46 * views))), middle = std::max(1, int(std::lround(0.34 * views)));
  add({10 * kRadian, 0, low});
  add({36 * kRadian, 0.5, middle});
  add({62 * kRadian, 0.25, std::max(1, views - low - middle)});
  rig.first = rig.poses.size();
  add({85 * kRadian, 0, 1});
  add({50 * kRadian, 0, 12});
  add({22 * kRadian, 0.5, 16});
  add({-5 * kRadian, 0.5, 16});
  add({-25 * kRadian, 0, 12});
  add({-50 * kRadian, 0.5, 8});
  add({-85 * kRadian, 0, 1});
  return rig;
}

Rig cameras_above(const std::vector<Vec>& targets, double distance, const FreeSpace& space) {
  constexpr int kAround = 8;
  Rig rig;
  for (std::size_t t = 0; t < targets.size(); ++t)
    for (const double elevation : {12.0, 32.0, 55.0})
      for (int k = 0; k < kAround; ++k) {
        const double phase = 0.37 * double(t);  // directions differ between targets
        const Vec out = direction(2 * std::numbers::pi * (k + phase) / kAround, elevation * kRadian);
        const double start = 0.06 * distance;  // not within the surface itself
        const Vec from = targets[t] + start * out;
        const double free = start + space.free_length(from, out, {kStops, 1.1 * distance - start}) - 0.1 * distance;
        if (free >= kNearestShare * distance) rig.poses.push_back({targets[t] + free * out, targets[t]});
      }
  return rig;
}

}  // namespace ngs::orbit
