#include "ngs/stages/extract/unseen_surface.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/stages/orbit/rigs.h"

namespace ngs {
namespace {

constexpr int kDirections = 96, kSide_px = 96;
constexpr double kFov_deg = 40;
constexpr double kBehind = 0.1;     // of the object's radius: how far behind the rendered depth a point is still seen
constexpr float kOpaque = 0.5f;     // of a pixel that shows a surface
constexpr int kNormalReach_px = 2;  // of the differences that say how a surface is turned

/// What the pictures of the object alone show, relative to the model's origin.
struct ShownPoint {
  orbit::Vec at, normal;  // normal: of any length, to the side that is looked at
  bool seen = false;
};

SplatOptions near_splat() {
  SplatOptions splat;
  splat.compat = Compat::kGsplat;  // the nearer near plane
  splat.max_sh_degree = 0;
  return splat;
}

/// Camera z of the surface in every pixel; 0: none.
ImageF depth_of(const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat) {
  RenderRequest request;
  request.colour = false, request.depth = true;
  const Exec serial;
  const RenderedView view = render(serial, cloud, camera, splat, request);
  ImageF depth(camera.width_px, camera.height_px, 1);
  for (std::size_t p = 0; p < depth.data.size(); ++p)
    if (view.alpha.data[p] >= kOpaque) depth.data[p] = view.depth.data[p] / view.alpha.data[p];
  return depth;
}

/// The points of a picture, place by place.
class PointPicture {
 public:
  PointPicture(const ImageF& depth, const Camera& relative) : depth_(depth), camera_(relative) {}

  bool has(int x, int y) const {
    return x >= 0 && y >= 0 && x < depth_.width_px && y < depth_.height_px && depth_.at(x, y) > 0;
  }
  orbit::Vec at(int x, int y) const {
    const double z = double(depth_.at(x, y));
    const orbit::Vec p{z * (x + 0.5 - camera_.cx) / camera_.fx, z * (y + 0.5 - camera_.cy) / camera_.fy, z};
    return transpose(camera_.rotation) * (p - camera_.translation);
  }
  /// The shorter of the two differences along a direction: the longer one may lead across a contour.
  orbit::Vec slope(int x, int y, int dx, int dy) const {
    orbit::Vec shortest{0, 0, 0};
    for (const int side : {1, -1}) {
      if (!has(x + side * dx, y + side * dy)) continue;
      const orbit::Vec d = double(side) * (at(x + side * dx, y + side * dy) - at(x, y));
      if (dot(shortest, shortest) == 0 || dot(d, d) < dot(shortest, shortest)) shortest = d;
    }
    return shortest;
  }

 private:
  const ImageF& depth_;
  const Camera& camera_;
};

std::vector<ShownPoint> shown_by(const GaussianCloud& object, const Camera& camera, const SplatOptions& splat) {
  const ImageF depth = depth_of(object, camera, splat);
  const Camera relative = relative_to(camera, object.origin);
  const PointPicture picture(depth, relative);
  const orbit::Vec eye = relative.centre();
  std::vector<ShownPoint> points;
  for (int y = 0; y < depth.height_px; ++y)
    for (int x = 0; x < depth.width_px; ++x) {
      if (!picture.has(x, y)) continue;
      const orbit::Vec at = picture.at(x, y);
      orbit::Vec normal = cross(picture.slope(x, y, kNormalReach_px, 0), picture.slope(x, y, 0, kNormalReach_px));
      if (dot(normal, normal) == 0) normal = eye - at;
      if (dot(normal, eye - at) < 0) normal = -1.0 * normal;
      points.push_back({at, normal});
    }
  return points;
}

/// Whether the camera has the point in its picture, and nothing before it.
bool sees(const Camera& relative, const ImageF& depth, orbit::Vec at, double behind) {
  const orbit::Vec p = relative.rotation * at + relative.translation;
  if (!(p.z > 0)) return false;
  const double x = relative.fx * p.x / p.z + relative.cx, y = relative.fy * p.y / p.z + relative.cy;
  if (!(x >= 0 && y >= 0 && x < relative.width_px && y < relative.height_px)) return false;
  const double surface = double(depth.at(int(x), int(y)));
  return !(surface > 0) || p.z <= surface + behind;
}

std::vector<Camera> cameras_about(const orbit::Ball& ball, const std::array<double, 3>& origin) {
  const orbit::Lens lens{kSide_px, kSide_px, kFov_deg};
  const orbit::Frame frame{.centre = ball.centre};
  std::vector<Camera> cameras;
  for (const orbit::Vec direction : orbit::even_directions(kDirections))
    cameras.push_back(
        orbit::camera_at({ball.radius / lens.least_half_sine() * direction, {0, 0, 0}}, lens, frame, origin));
  return cameras;
}

UnseenSurface summed(const std::vector<std::vector<ShownPoint>>& pictures) {
  const std::vector<orbit::Vec> directions = orbit::even_directions(kDirections);
  UnseenSurface out;
  double all = 0;
  for (std::size_t d = 0; d < pictures.size(); ++d) {
    const std::vector<ShownPoint>& points = pictures[d];
    const auto unseen = double(std::ranges::count(points, false, &ShownPoint::seen));
    all += double(points.size()), out.share += unseen;
    if (unseen > out.worst * double(points.size()))
      out.worst = unseen / double(points.size()), out.direction = directions[d];
  }
  if (all > 0) out.share /= all;
  return out;
}

}  // namespace

UnseenSurface unseen_surface(const Exec& exec, Monitor& monitor, const UnseenInput& input) {
  NGS_CHECK(std::int64_t(input.object.size()) == input.cloud.size(), "one entry per Gaussian");
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < input.object.size(); ++i)
    if (input.object[i] && input.cloud.usable[i]) rows.push_back(std::int64_t(i));
  const GaussianCloud object = gather_rows(exec, input.cloud, rows);
  const orbit::SurfacePoints points = orbit::surface_points(object);
  if (points.count() == 0) return {};
  const orbit::Ball ball = orbit::bulk_of(points);
  const std::vector<Camera> about = cameras_about(ball, object.origin);
  const SplatOptions alone = prepared_for(exec, near_splat(), object),
                     whole = prepared_for(exec, near_splat(), input.cloud);
  std::vector<std::vector<ShownPoint>> pictures(about.size());
  const auto timed = monitor.scope("unseen surface");
  for_each_task(exec, std::int64_t(about.size()),
                [&](std::int64_t d) { pictures[std::size_t(d)] = shown_by(object, about[std::size_t(d)], alone); });
  for (const Camera& camera : input.cameras) {
    const ImageF depth = depth_of(input.cloud, camera, whole);
    const Camera relative = relative_to(camera, input.cloud.origin);
    const orbit::Vec eye = relative.centre();
    for_each_task(exec, std::int64_t(pictures.size()), [&](std::int64_t d) {
      for (ShownPoint& point : pictures[std::size_t(d)])
        point.seen |= dot(eye - point.at, point.normal) > 0 && sees(relative, depth, point.at, kBehind * ball.radius);
    });
  }
  return summed(pictures);
}

}  // namespace ngs
