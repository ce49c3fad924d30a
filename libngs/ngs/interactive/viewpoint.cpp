#include "ngs/interactive/viewpoint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/core/error.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/orbit/rigs.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/geometry/stance.h"

namespace ngs::live {
namespace {

using orbit::Vec;

constexpr double kFov_deg = 50;
constexpr double kRaised_deg = 15;           // above the horizontal, from outside
constexpr std::size_t kMaxPoints = 200'000;  // for the estimate of the bulk
constexpr std::size_t kMostSeen = 100'000;   // in pictures of 160x120
constexpr int kCells = 64;

/// Every k-th point, enough for the bulk of a large model.
orbit::SurfacePoints fewer(const orbit::SurfacePoints& all) {
  orbit::SurfacePoints some;
  for (const std::size_t i : orbit::thinned(all.count(), kMaxPoints)) some.add(all, i);
  return some;
}

/// Every k-th Gaussian with k times the area, for small pictures.
GaussianCloud coarse(const Exec& exec, const GaussianCloud& cloud) {
  const std::vector<std::size_t> kept = orbit::thinned(std::size_t(cloud.size()), kMostSeen);
  GaussianCloud some = gather_rows(exec, cloud, {kept.begin(), kept.end()});
  const double times = double(cloud.size()) / double(kept.size());
  for (float& s : some.log_scale) s += float(0.5 * std::log(times));
  return some;
}

/// Poses inside a room that look slightly downwards.
std::vector<orbit::Pose> within(const orbit::RoomFinding& room, double radius) {
  constexpr std::size_t kStands = 4;
  constexpr int kDirections = 8;
  constexpr double kDown = 0.2;  // tangent
  std::vector<orbit::Pose> poses;
  for (std::size_t s = 0; s < std::min(kStands, room.viewpoints.size()); ++s)
    for (int k = 0; k < kDirections; ++k) {
      const double turn = 2 * std::numbers::pi * k / kDirections;
      poses.push_back({room.viewpoints[s], room.viewpoints[s] + radius * Vec{std::cos(turn), std::sin(turn), -kDown}});
    }
  return poses;
}

std::vector<orbit::Pose> outside(double radius) {
  constexpr int kDirections = 12;
  const double half = std::sin(0.5 * kFov_deg * std::numbers::pi / 180), raised = kRaised_deg * std::numbers::pi / 180;
  std::vector<orbit::Pose> poses;
  for (int k = 0; k < kDirections; ++k) {
    const double turn = 2 * std::numbers::pi * k / kDirections;
    const Vec out{std::cos(raised) * std::cos(turn), std::cos(raised) * std::sin(turn), std::sin(raised)};
    poses.push_back({(1.05 * radius / half) * out, {0, 0, 0}});
  }
  return poses;
}

/// Amount of detail: the mean colour difference between a pixel and its neighbours.
double detail_of(const ImageF& image) {
  double sum = 0;
  for (int y = 1; y < image.height_px; ++y)
    for (int x = 1; x < image.width_px; ++x)
      for (int c = 0; c < 3; ++c)
        sum += std::abs(double(image.at(x, y, c) - image.at(x - 1, y, c))) +
               std::abs(double(image.at(x, y, c) - image.at(x, y - 1, c)));
  return sum / double(image.pixels());
}

}  // namespace

bool operator==(const Viewpoint& a, const Viewpoint& b) {
  return has_same_pose(a, b) && a.fov_y_deg == b.fov_y_deg && a.width_px == b.width_px && a.height_px == b.height_px;
}

bool has_same_pose(const Viewpoint& a, const Viewpoint& b) {
  const auto equal = [](Vec u, Vec v) { return u.x == v.x && u.y == v.y && u.z == v.z; };
  return equal(a.position, b.position) && equal(a.look_at, b.look_at) && equal(a.up, b.up);
}

Camera camera_of(const Viewpoint& viewpoint) {
  const Vec line = viewpoint.look_at - viewpoint.position;
  if (!(length(line) > 0)) throw Error(ErrorCode::kUsage, "camera: position and look_at are one point, expected two");
  const Vec forward = unit(line);
  Vec right = cross(forward, unit(viewpoint.up));
  right = length(right) > 1e-6 ? unit(right) : orbit::perpendicular(forward);
  const Vec down = cross(forward, right);
  Camera camera;
  camera.width_px = viewpoint.width_px;
  camera.height_px = viewpoint.height_px;
  camera.fx = camera.fy = 0.5 * viewpoint.height_px / std::tan(0.5 * viewpoint.fov_y_deg * std::numbers::pi / 180);
  camera.cx = 0.5 * viewpoint.width_px;
  camera.cy = 0.5 * viewpoint.height_px;
  camera.rotation = {{right.x, right.y, right.z, down.x, down.y, down.z, forward.x, forward.y, forward.z}};
  camera.translation = -1.0 * (camera.rotation * viewpoint.position);
  return camera;
}

InitialViewpoint initial_viewpoint(const Exec& exec, const GaussianCloud& cloud) {
  const orbit::SurfacePoints points = orbit::surface_points(cloud);
  if (points.count() == 0)
    throw Error(ErrorCode::kNothingFound,
                "the model: none of its " + std::to_string(cloud.size()) +
                    " Gaussians is usable with an opacity above 1/255, expected visible Gaussians");
  const orbit::SurfacePoints some = fewer(points);
  const orbit::Ball bulk = orbit::bulk_of(some);
  const Vec up = orbit::guess_up(some, bulk).up, origin{cloud.origin[0], cloud.origin[1], cloud.origin[2]};
  const orbit::Ball ball = orbit::ball_to_frame(some, bulk, up);
  const orbit::Frame frame = orbit::frame_about(some, ball, up);
  const orbit::FreeSpace space(cloud, points, frame, {1.1 * ball.radius, kCells});
  const orbit::RoomFinding room = orbit::find_room(exec, space, ball.radius);
  const double nearest = room.is_room() ? ball.radius : 1.2 * ball.radius;
  InitialViewpoint first{
      ball.centre + origin, ball.radius, up, {}, world_unit_for(nearest, near_plane(Compat::kInria))};
  SplatOptions splat{.antialiased = cloud.antialiased, .max_sh_degree = 0, .world_unit = first.world_unit};
  const GaussianCloud seen = coarse(exec, cloud);
  splat = prepared_for(exec, splat, seen);
  double max_detail = -1;
  for (const orbit::Pose& pose : room.is_room() ? within(room, ball.radius) : outside(ball.radius)) {
    Viewpoint viewpoint{
        frame.to_world(pose.centre) + origin, frame.to_world(pose.target) + origin, up, kFov_deg, 160, 120};
    const double detail = detail_of(render(exec, seen, camera_of(viewpoint), splat, {}).colour);
    if (detail > max_detail) {
      max_detail = detail;
      first.viewpoint = viewpoint;
    }
  }
  first.viewpoint.width_px = Viewpoint().width_px;
  first.viewpoint.height_px = Viewpoint().height_px;
  return first;
}

}  // namespace ngs::live
