#include "ngs/orbit/rigs.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "ngs/math/quat.h"

namespace ngs::orbit {
namespace {

constexpr int kMaxParts = 32;  // along an axis

/// A fraction of a Gaussian's extinction, at an offset from its centre in its own axes.
struct Part {
  Vec offset;
  double share;
};

/// Splits a Gaussian within 1.5 standard deviations into parts no wider than a cell. The shares sum to 1.
std::vector<Part> parts_of(const double (&deviation)[3], double cell) {
  int count[3];
  for (int k = 0; k < 3; ++k) count[k] = int(std::clamp(std::ceil(3 * deviation[k] / cell), 1.0, double(kMaxParts)));
  const auto at = [&](int axis, int k) { return count[axis] == 1 ? 0 : 3.0 * (k + 0.5) / count[axis] - 1.5; };
  std::vector<Part> parts;
  double total = 0;
  for (int k = 0; k < count[0] * count[1] * count[2]; ++k) {
    const Vec u{at(0, k % count[0]), at(1, k / count[0] % count[1]), at(2, k / count[0] / count[1])};
    parts.push_back({{deviation[0] * u.x, deviation[1] * u.y, deviation[2] * u.z}, std::exp(-0.5 * dot(u, u))});
    total += parts.back().share;
  }
  for (Part& part : parts) part.share /= total;
  return parts;
}

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

FreeSpace::FreeSpace(const GaussianCloud& cloud, const SurfacePoints& points, const Frame& frame, Cube cube)
    : cube_(cube), size_(2 * cube.half / cube.cells) {
  const auto side = std::size_t(cube.cells);
  extinction_.assign(side * side * side, 0.f);
  const double volume = size_ * size_ * size_;
  for (std::size_t i = 0; i < points.count(); ++i) {
    const Vec p = frame.from_world(points.position[i]);
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > cube.half + 1.5 * points.size[i]) continue;
    const float* log_scale = &cloud.log_scale[3 * std::size_t(points.row[i])];
    const float* q = &cloud.rotation[4 * std::size_t(points.row[i])];
    const double s[3] = {std::exp(double(log_scale[0])), std::exp(double(log_scale[1])),
                         std::exp(double(log_scale[2]))};
    const double extinction =
        points.opacity[i] * 6.283185307179586 / 3 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]) / volume;
    const auto add = [&](Vec at, double share) {
      if (const std::int64_t cell = cell_at(at); cell >= 0) extinction_[std::size_t(cell)] += float(extinction * share);
    };
    if (3 * points.size[i] <= size_) {
      add(p, 1);
      continue;
    }
    const Mat3<double> turned = frame.axes * axes_of_quaternion(q);
    for (const Part& part : parts_of(s, size_)) add(p + turned * part.offset, part.share);
  }
}

std::int64_t FreeSpace::cell_at(Vec p) const {
  const double x = (p.x + cube_.half) / size_, y = (p.y + cube_.half) / size_, z = (p.z + cube_.half) / size_;
  const double n = cube_.cells;
  if (!(x >= 0 && y >= 0 && z >= 0 && x < n && y < n && z < n)) return -1;
  return (std::int64_t(z) * cube_.cells + std::int64_t(y)) * cube_.cells + std::int64_t(x);
}

double FreeSpace::depth_at(Vec p) const {
  const std::int64_t cell = cell_at(p);
  return cell < 0 ? 0 : size_ * double(extinction_[std::size_t(cell)]);
}

double FreeSpace::free_length(Vec from, Vec direction, Reach reach) const {
  const double step = 0.5 * size_;
  double depth = 0;
  for (double at = 0.5 * step; at < reach.most; at += step)
    if ((depth += 0.5 * depth_at(from + at * direction)) >= reach.limit) return at - 0.5 * step;
  return reach.most;
}

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
  camera.width_px = intrinsics.width_px, camera.height_px = intrinsics.height_px;
  camera.fx = camera.fy = intrinsics.focal_px();
  camera.cx = 0.5 * intrinsics.width_px, camera.cy = 0.5 * intrinsics.height_px;
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
