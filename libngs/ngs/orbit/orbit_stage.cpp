#include "ngs/orbit/orbit_stage.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <sstream>

#include "ngs/core/error.h"
#include "ngs/core/formatted.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/orbit/coverage.h"
#include "ngs/orbit/rigs.h"
#include "ngs/scene/geometry/stance.h"

namespace ngs::orbit {
namespace {

constexpr int kVisibilitySide_px = 200;              // shorter side of the visibility renders
constexpr double kMaxBlocked = 0.15;                 // largest Visibility::blocked of a candidate
constexpr double kOutsideFov = 40, kInsideFov = 80;  // deg
constexpr double kRoomCoverage = 0.7;                // least coverage of cameras inside a room
constexpr double kNearFov = 50;                      // deg
constexpr double kNearShare = 0.25;                  // obstacles: nearer than this share of the distance
constexpr double kNearDistance = 2.2;                // in radii of the ball that contains half of the Gaussians
constexpr double kRoomReach = 1.5;                   // extent of a room's surface, in radii of the bulk

std::string number(double value) { return formatted("%.4g", value); }

/// The given rows of the model, without SH bands above 0.
GaussianCloud rows_of(const GaussianCloud& cloud, const std::vector<std::uint32_t>& rows) {
  GaussianCloud part;
  part.origin = cloud.origin;
  part.resize(std::int64_t(rows.size()), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t from = rows[i];
    std::copy_n(&cloud.position[3 * from], 3, &part.position[3 * i]);
    std::copy_n(&cloud.rotation[4 * from], 4, &part.rotation[4 * i]);
    std::copy_n(&cloud.log_scale[3 * from], 3, &part.log_scale[3 * i]);
    part.logit_opacity[i] = cloud.logit_opacity[from];
  }
  return part;
}

class Chooser {
 public:
  Chooser(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const OrbitOptions& options)
      : exec_(exec), monitor_(monitor), cloud_(cloud), options_(options), points_(surface_points(cloud)) {
    if (points_.count() == 0)
      throw Error(ErrorCode::kNothingFound,
                  "the model: none of its " + std::to_string(cloud.size()) +
                      " Gaussians is usable with an opacity above 1/255, expected visible Gaussians");
  }

  OrbitCameras run(PictureSize size) {
    find_ball();
    find_up();
    frame_ = frame_about(points_, ball_, found_.up);
    const std::optional<RoomFinding> room = look_for_room();
    const bool chooses = options_.place == Place::kAuto || options_.place == Place::kNear;
    if (options_.place == Place::kNear && !(room && room->is_room())) come_near();
    if (!room || (chooses && !room->is_room())) return placed(size, nullptr);
    OrbitCameras inside = placed(size, &*room);
    if (options_.place == Place::kInside || inside.coverage >= std::min(kRoomCoverage, options_.coverage))
      return inside;
    OrbitCameras outside = placed(size, nullptr);  // the gaps of a thicket are no room
    return outside.coverage > inside.coverage ? outside : inside;
  }

  OrbitCameras assess(std::vector<Camera> cameras) {
    find_ball();
    const auto timed = monitor_.scope("visibility from " + std::to_string(cameras.size()) + " places");
    Vec up{0, 0, 0};
    for (const Camera& camera : cameras) {
      rig_.poses.push_back({camera.centre() - origin() - ball_.centre, {}});
      found_.inside |= length(rig_.poses.back().centre) < ball_.radius;
      up = up - Vec{camera.rotation(1, 0), camera.rotation(1, 1), camera.rotation(1, 2)};
    }
    if (length(up) > 0) found_.up = unit(up);
    const Rows rows = rows_in_reach();
    const GaussianCloud part = rows_of(cloud_, rows.row);
    const PointVisibility renderer(exec_, part, rows.point, found_.world_unit);
    for (const Camera& camera : cameras) visibility_.push_back(renderer.of(exec_, small(camera), 0));
    Coverage coverage(weight_, visibility_);
    for (const Visibility& visibility : visibility_) coverage.add(visibility);
    found_.candidates = cameras.size();
    found_.cameras = std::move(cameras);
    found_.coverage = coverage.share();
    found_.surface = coverage.gaussians();
    return found_;
  }

 private:
  void find_ball() {
    bulk_ = bulk_of(points_);
    ball_ = bulk_;
    if (!options_.around.empty()) {
      ball_ = parse_ball(options_.around);
      ball_.centre = ball_.centre - origin();
    }
  }

  void find_up() {
    const UpGuess guess =
        options_.up == UpAxis::kAuto ? guess_up(points_, bulk_) : UpGuess{axis_of(options_.up), false};
    found_.up = guess.up;
    found_.up_is_guessed = guess.found;
    if (options_.around.empty()) ball_ = ball_to_frame(points_, bulk_, found_.up);
    found_.centre = ball_.centre + origin();
    found_.radius = ball_.radius;
  }

  std::optional<RoomFinding> look_for_room() {
    if (options_.place == Place::kOutside || (options_.place != Place::kInside && !options_.around.empty())) return {};
    const auto timed = monitor_.scope("inside or outside");
    const FreeSpace space(cloud_, points_, frame_, {1.1 * ball_.radius, 64});
    RoomFinding room = find_room(exec_, space, ball_.radius);
    if (options_.place == Place::kInside && room.viewpoints.empty())
      throw Error(ErrorCode::kNothingFound,
                  "--place inside: the model surrounds no free space, expected some for a camera",
                  "leave it out, or give a ball that contains the room: --around X,Y,Z,R");
    return room;
  }

  /// The ball that contains half of the Gaussians, as photos are taken of what many Gaussians show; not if it is more
  /// than half as wide as the model: that is an object without surroundings.
  void come_near() {
    std::vector<double> distance;
    for (const Vec& p : points_.position) distance.push_back(length(p - bulk_.centre));
    const double half = weighted_quantile(distance, points_.opacity, 0.5);
    near_ = options_.around.empty() && half > 0 && weighted_quantile(distance, points_.opacity, 0.98) > 2 * half;
    if (!near_) return;
    ball_ = {bulk_.centre, half};
    found_.centre = ball_.centre + origin();
    found_.radius = ball_.radius;
    frame_ = frame_about(points_, ball_, found_.up);
  }

  /// Gaussians of the ball that are far from one another, in the frame.
  std::vector<Vec> targets() const {
    constexpr std::size_t kTargets = 16, kSamples = 2000;
    std::vector<Vec> sample, chosen;
    for (const std::size_t i : thinned(points_.count(), kSamples))
      if (const Vec p = frame_.from_world(points_.position[i]); length(p) <= ball_.radius) sample.push_back(p);
    std::vector<double> distance(sample.size());
    for (std::size_t i = 0; i < sample.size(); ++i) distance[i] = 3 * ball_.radius - length(sample[i]);
    while (chosen.size() < std::min(kTargets, sample.size())) {
      chosen.push_back(sample[std::size_t(std::ranges::max_element(distance) - distance.begin())]);
      for (std::size_t i = 0; i < sample.size(); ++i)
        distance[i] = std::min(distance[i], length(sample[i] - chosen.back()));
    }
    return chosen;
  }

  Rig above() {
    const auto timed = monitor_.scope("free space");
    const double distance = kNearDistance * ball_.radius;
    const FreeSpace space(cloud_, points_, frame_, {1.1 * distance + ball_.radius, 128});
    Rig rig = cameras_above(targets(), distance, space);
    if (rig.poses.empty()) fail_blocked();
    return rig;
  }

  Rig rings() {
    const auto timed = monitor_.scope("free space");
    const double reach = 1.1 * ball_.radius / intrinsics_.least_half_sine() + ball_.radius;
    const FreeSpace space(cloud_, points_, frame_, {reach, 128});
    Rig rig = rings_about(ball_.radius, intrinsics_, space, first_views());
    if (rig.poses.empty()) fail_blocked();
    return rig;
  }

  [[noreturn]] void fail_blocked() const {
    throw Error(ErrorCode::kNothingFound,
                "no place for a camera around the ball of radius " + number(ball_.radius) +
                    ": every line of sight is blocked, expected free space",
                "give a smaller ball: --around X,Y,Z,R, or place cameras inside: --place inside");
  }

  /// Renderers cull everything nearer than their near plane: it must not reach the model.
  void choose_world_unit() {
    double nearest = 0.1 * ball_.radius;
    if (!found_.inside && !near_) {
      nearest = length(rig_.poses.front().centre);
      for (const Pose& pose : rig_.poses) nearest = std::min(nearest, length(pose.centre));
      nearest -= ball_.radius;
    }
    found_.world_unit = world_unit_for(nearest, near_plane(Compat::kInria));
  }

  /// The cameras in the room, or around the ball if `room` is null.
  OrbitCameras placed(PictureSize size, const RoomFinding* room) {
    found_.inside = room != nullptr;
    found_.cameras.clear();
    visibility_.clear();
    const double fov = options_.fov_deg > 0 ? options_.fov_deg
                       : found_.inside      ? kInsideFov
                       : near_              ? kNearFov
                                            : kOutsideFov;
    intrinsics_ = {size.width_px, size.height_px, fov};
    rig_ = found_.inside ? cameras_within(room->viewpoints, ball_.radius) : near_ ? above() : rings();
    choose_world_unit();
    render_candidates();
    select_cameras();
    return found_;
  }

  /// Rows of the model that a camera can see or be blocked by, and which of them are points of interest.
  struct Rows {
    std::vector<std::uint32_t> row;
    std::vector<std::int32_t> point;  // index of the point of interest, or -1
  };
  Rows rows_in_reach() {
    double reach = kRoomReach * ball_.radius;
    for (const Pose& pose : rig_.poses) reach = std::max(reach, length(pose.centre) + ball_.radius);
    const double interest = found_.inside ? kRoomReach * ball_.radius : ball_.radius;
    const double most_weight = 0.0314 * ball_.radius * ball_.radius;  // a disc of a tenth of the radius
    Rows rows;
    weight_.clear();
    for (std::size_t i = 0; i < points_.count(); ++i) {
      const double distance = length(points_.position[i] - ball_.centre);
      if (distance > reach + 2 * points_.size[i]) continue;
      rows.row.push_back(points_.row[i]);
      rows.point.push_back(distance <= interest ? std::int32_t(weight_.size()) : -1);
      if (distance > interest) continue;
      weight_.push_back(near_ ? points_.opacity[i] : std::min(points_.area[i], most_weight * points_.opacity[i]));
    }
    if (weight_.empty())
      throw Error(ErrorCode::kNothingFound,
                  "--around " + options_.around + ": no visible Gaussian in this ball, expected some",
                  "centre and radius are in the coordinates of the model's file");
    return rows;
  }

  /// Renders the visibility from every candidate at low resolution, and removes blocked candidates.
  void render_candidates() {
    const auto timed = monitor_.scope("visibility from " + std::to_string(rig_.poses.size()) + " places");
    const Rows rows = rows_in_reach();
    const GaussianCloud part = rows_of(cloud_, rows.row);
    const PointVisibility renderer(exec_, part, rows.point, found_.world_unit);
    Rig unblocked;
    for (std::size_t p = 0; p < rig_.poses.size(); ++p) {
      const Pose& pose = rig_.poses[p];
      const double before = found_.inside ? 0
                            : near_       ? kNearShare * length(pose.target - pose.centre)
                                          : length(pose.centre) - ball_.radius;
      Visibility visibility = renderer.of(exec_, small(camera_at(pose, intrinsics_, frame_, cloud_.origin)), before);
      monitor_.progress(std::int64_t(p) + 1, std::int64_t(rig_.poses.size()));
      if (visibility.blocked > kMaxBlocked) continue;
      unblocked.first += p < rig_.first;
      unblocked.poses.push_back(pose);
      visibility_.push_back(std::move(visibility));
    }
    found_.candidates = rig_.poses.size();
    rig_ = std::move(unblocked);
    if (rig_.poses.empty()) fail_blocked();
  }

  static Camera small(const Camera& camera) {
    const double scale = std::min(1.0, double(kVisibilitySide_px) / std::min(camera.width_px, camera.height_px));
    return resized(camera, scaled_size_px(camera.width_px, scale), scaled_size_px(camera.height_px, scale));
  }

  void select_cameras() {
    Coverage coverage(weight_, visibility_);
    std::vector<std::uint8_t> chosen(rig_.poses.size(), 0);
    const auto choose = [&](std::size_t p) {
      chosen[p] = 1;
      coverage.add(visibility_[p]);
      Camera camera = camera_at(rig_.poses[p], intrinsics_, frame_, cloud_.origin);
      char name[24];
      std::snprintf(name, sizeof name, "%04d.png", int(found_.cameras.size()));
      camera.name = name;
      found_.cameras.push_back(std::move(camera));
    };
    for (std::size_t p = 0; p < rig_.first; ++p) choose(p);
    const auto views = [&] { return std::ssize(found_.cameras); };
    while (views() < first_views() || (coverage.share() < options_.coverage && views() < options_.max_views)) {
      double most = 0;
      std::size_t best = 0;
      for (std::size_t p = 0; p < rig_.poses.size(); ++p)
        if (const double gain = chosen[p] ? 0 : coverage.gain(visibility_[p]); gain > most) {
          most = gain;
          best = p;
        }
      if (!(most > 0)) break;
      choose(best);
    }
    found_.coverage = coverage.share();
    found_.surface = coverage.gaussians();
  }

  int first_views() const { return std::min(options_.view_count, options_.max_views); }
  Vec origin() const { return {cloud_.origin[0], cloud_.origin[1], cloud_.origin[2]}; }

  const Exec& exec_;
  Monitor& monitor_;
  const GaussianCloud& cloud_;
  const OrbitOptions& options_;
  SurfacePoints points_;
  Ball bulk_, ball_;
  Frame frame_;
  Intrinsics intrinsics_;
  Rig rig_;
  std::vector<double> weight_;          // [points of interest]
  std::vector<Visibility> visibility_;  // [poses]
  OrbitCameras found_;
  bool near_ = false;  // cameras above the ball and near to it
};

}  // namespace

Ball parse_ball(const std::string& text) {
  double value[4] = {};
  std::size_t at = 0;
  int count = 0;
  std::istringstream in(text);
  for (std::string part; count < 4 && std::getline(in, part, ','); ++count) {
    char* end = nullptr;
    value[count] = std::strtod(part.c_str(), &end);
    if (part.empty() || *end != '\0' || !std::isfinite(value[count])) break;
    at += part.size() + 1;
  }
  if (count != 4 || at != text.size() + 1 || !(value[3] > 0))
    throw Error(ErrorCode::kUsage, "--around " + text + ": no ball, expected X,Y,Z,R with a radius R above 0",
                "such as --around 0.5,-1,2,0.3");
  return {{value[0], value[1], value[2]}, value[3]};
}

Vec axis_of(UpAxis up) {
  switch (up) {
    case UpAxis::kX: return {1, 0, 0};
    case UpAxis::kY: return {0, 1, 0};
    case UpAxis::kZ: return {0, 0, 1};
    case UpAxis::kMinusX: return {-1, 0, 0};
    case UpAxis::kMinusZ: return {0, 0, -1};
    case UpAxis::kMinusY:
    case UpAxis::kAuto: break;
  }
  return {0, -1, 0};
}

OrbitCameras choose_cameras(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const OrbitOptions& options,
                            PictureSize size) {
  return Chooser(exec, monitor, cloud, options).run(size);
}

OrbitCameras assess_cameras(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const OrbitOptions& options,
                            std::vector<Camera> cameras) {
  return Chooser(exec, monitor, cloud, options).assess(std::move(cameras));
}

}  // namespace ngs::orbit
