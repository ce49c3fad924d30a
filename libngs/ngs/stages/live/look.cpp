#include "ngs/stages/live/look.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ngs/core/error.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/stages/orbit/rigs.h"

namespace ngs::live {
namespace {

using orbit::Vec;

constexpr double kFov_deg = 50;
constexpr double kRaised_deg = 15;            // above the horizontal, from outside
constexpr std::size_t kMostPoints = 200'000;  // that the bulk is told from
constexpr int kCells = 64;

/// Every k-th point: where the bulk of a large model lies does not hang on single Gaussians.
orbit::SurfacePoints fewer(const orbit::SurfacePoints& all) {
  orbit::SurfacePoints some;
  for (const std::size_t i : orbit::thinned(all.count(), kMostPoints)) {
    some.row.push_back(all.row[i]), some.position.push_back(all.position[i]);
    some.opacity.push_back(all.opacity[i]), some.size.push_back(all.size[i]), some.area.push_back(all.area[i]);
  }
  return some;
}

/// From a place within, level, to where one sees farthest.
orbit::Pose within(const orbit::FreeSpace& space, Vec stand, double radius) {
  Vec best{1, 0, 0};
  double farthest = -1;
  for (int k = 0; k < 24; ++k) {
    const double turn = 2 * std::numbers::pi * k / 24;
    const Vec level{std::cos(turn), std::sin(turn), 0};
    const double reach = space.free_length(stand, level, {1, 4 * radius});
    if (reach > farthest) farthest = reach, best = level;
  }
  return {stand, stand + std::max(0.1 * radius, farthest) * best};
}

orbit::Pose outside(double radius) {
  const double half = std::sin(0.5 * kFov_deg * std::numbers::pi / 180), raised = kRaised_deg * std::numbers::pi / 180;
  return {(1.05 * radius / half) * Vec{std::cos(raised), 0, std::sin(raised)}, {0, 0, 0}};
}

}  // namespace

Camera camera_of(const Look& look) {
  const Vec line = look.look_at - look.position;
  if (!(orbit::length(line) > 0))
    throw Error(ErrorCode::kUsage, "camera: position and look_at are one point, expected two");
  const Vec forward = orbit::unit(line);
  Vec right = cross(forward, orbit::unit(look.up));
  right = orbit::length(right) > 1e-6 ? orbit::unit(right) : orbit::perpendicular(forward);
  const Vec down = cross(forward, right);
  Camera camera;
  camera.width_px = look.width_px, camera.height_px = look.height_px;
  camera.fx = camera.fy = 0.5 * look.height_px / std::tan(0.5 * look.fov_y_deg * std::numbers::pi / 180);
  camera.cx = 0.5 * look.width_px, camera.cy = 0.5 * look.height_px;
  camera.rotation = {{right.x, right.y, right.z, down.x, down.y, down.z, forward.x, forward.y, forward.z}};
  camera.translation = -1.0 * (camera.rotation * look.position);
  return camera;
}

FirstLook first_look(const Exec& exec, const GaussianCloud& cloud) {
  const orbit::SurfacePoints points = orbit::surface_points(cloud);
  if (points.count() == 0)
    throw Error(ErrorCode::kNothingFound,
                "the model: none of its " + std::to_string(cloud.size()) +
                    " Gaussians is usable and has an opacity above 1/255, expected some that can be seen");
  const orbit::SurfacePoints some = fewer(points);
  const orbit::Ball ball = orbit::bulk_of(some);
  const Vec up = orbit::guess_up(some, ball).up, origin{cloud.origin[0], cloud.origin[1], cloud.origin[2]};
  const orbit::Frame frame = orbit::frame_about(some, ball, up);
  const orbit::FreeSpace space(cloud, points, frame, {1.1 * ball.radius, kCells});
  const orbit::RoomFinding room = orbit::find_room(exec, space, ball.radius);
  const orbit::Pose pose = room.is_room() ? within(space, room.stands.front(), ball.radius) : outside(ball.radius);
  FirstLook first{ball.centre + origin, ball.radius, up, {}, Compat::kInria};
  first.look.position = frame.to_world(pose.centre) + origin, first.look.look_at = frame.to_world(pose.target) + origin;
  first.look.up = up, first.look.fov_y_deg = kFov_deg;
  const double nearest = room.is_room() ? 0.1 * ball.radius : orbit::length(pose.centre) - ball.radius;
  if (nearest < near_plane(Compat::kInria)) first.compat = Compat::kGsplat;
  return first;
}

}  // namespace ngs::live
