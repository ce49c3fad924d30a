#include "ngs/edit/extract/unseen_surface.h"

#include <algorithm>
#include <optional>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/orbit/rigs.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/scene/geometry/unproject.h"

namespace ngs {
namespace {

constexpr int kDirections = 96, kSide_px = 96;
constexpr double kFov_deg = 40;
constexpr double kBehind = 0.1;     // fraction of the object's radius: depth tolerance of the visibility test
constexpr float kOpaque = 0.5f;     // least alpha of a pixel that shows a surface
constexpr int kNormalReach_px = 2;  // step of the depth differences for normals

/// A surface point in a render of the object alone, relative to the model's origin.
struct SurfacePixel {
  orbit::Vec at, normal;  // normal: of any length, towards the camera
  bool seen = false;
};

/// `radius`: of the object; cameras around it are about twice as far from its surface.
SplatOptions near_splat(double radius) {
  SplatOptions splat;
  splat.compat = Compat::kGsplat;  // for its nearer near plane
  splat.max_sh_degree = 0;
  splat.world_unit = world_unit_for(radius, near_plane(Compat::kGsplat));
  return splat;
}

/// Camera z of the surface in every pixel; 0: no surface. `touching`: RenderRequest::tiles_touching.
ImageF depth_of(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat,
                const std::uint8_t* touching) {
  RenderRequest request;
  request.colour = false;
  request.depth = true;
  request.tiles_touching = touching;
  const RenderedView view = render(exec, cloud, camera, splat, request);
  ImageF depth(camera.width_px, camera.height_px, 1);
  for (std::size_t p = 0; p < depth.data.size(); ++p)
    if (view.alpha.data[p] >= kOpaque) depth.data[p] = view.depth.data[p] / view.alpha.data[p];
  return depth;
}

/// The surface points of a depth image, by pixel.
class PointImage {
 public:
  PointImage(const ImageF& depth, const Camera& relative) : depth_(depth), camera_(relative) {}

  bool has(int x, int y) const {
    return x >= 0 && y >= 0 && x < depth_.width_px && y < depth_.height_px && depth_.at(x, y) > 0;
  }
  orbit::Vec at(int x, int y) const { return unproject(camera_, x + 0.5, y + 0.5, double(depth_.at(x, y))); }
  /// The shorter of the forward and backward differences along a direction: the longer one may cross a contour.
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

std::vector<SurfacePixel> surface_pixels(const GaussianCloud& object, const Camera& camera, const SplatOptions& splat) {
  const Exec serial;
  const ImageF depth = depth_of(serial, object, camera, splat, nullptr);
  const Camera relative = relative_to(camera, object.origin);
  const PointImage image(depth, relative);
  const orbit::Vec eye = relative.centre();
  std::vector<SurfacePixel> points;
  for (int y = 0; y < depth.height_px; ++y)
    for (int x = 0; x < depth.width_px; ++x) {
      if (!image.has(x, y)) continue;
      const orbit::Vec at = image.at(x, y);
      orbit::Vec normal = cross(image.slope(x, y, kNormalReach_px, 0), image.slope(x, y, 0, kNormalReach_px));
      if (dot(normal, normal) == 0) normal = eye - at;
      if (dot(normal, eye - at) < 0) normal = -1.0 * normal;
      points.push_back({at, normal});
    }
  return points;
}

/// Finds the points of the renders that a view of the capture sees. Only a window about points that no earlier view saw
/// is rendered.
class SeeingView {
 public:
  SeeingView(const GaussianCloud& cloud, const Camera& camera)
      : camera_(camera), relative_(relative_to(camera, cloud.origin)), eye_(relative_.centre()) {}

  /// The pixels of the unseen points that face the camera.
  ForegroundBox box_of(const std::vector<SurfacePixel>& points) const {
    ForegroundBox box;
    for (const SurfacePixel& point : points)
      if (const std::optional<orbit::Vec> p = pixel_of(point)) box.add(int(p->x), int(p->y));
    return box;
  }
  /// render(camera) returns the depth of a window.
  template <class Render>
  void render_window(const ForegroundBox& box, const Render& render) {
    window_ = widened({box.x0, box.y0, box.x1 - box.x0, box.y1 - box.y0}, 0, camera_.width_px, camera_.height_px);
    depth_ = render(window_camera(camera_, window_));
  }
  /// Marks the points that are not occluded; `behind`: depth tolerance.
  void mark_seen(double behind, std::vector<SurfacePixel>& points) const {
    for (SurfacePixel& point : points)
      if (const std::optional<orbit::Vec> p = pixel_of(point)) {
        const double surface = double(depth_.at(int(p->x) - window_.x0, int(p->y) - window_.y0));
        point.seen = !(surface > 0) || p->z <= surface + behind;
      }
  }

 private:
  /// x, y and depth; nullopt if the point is seen, faces away or lies outside the image.
  std::optional<orbit::Vec> pixel_of(const SurfacePixel& point) const {
    if (point.seen || !(dot(eye_ - point.at, point.normal) > 0)) return std::nullopt;
    return relative_.project(point.at);
  }

  const Camera& camera_;
  Camera relative_;
  orbit::Vec eye_;
  PixelWindow window_;
  ImageF depth_;  // of the window
};

std::vector<Camera> cameras_around(const orbit::Ball& ball, const std::array<double, 3>& origin) {
  const orbit::Intrinsics intrinsics{kSide_px, kSide_px, kFov_deg};
  const orbit::Frame frame{.centre = ball.centre};
  std::vector<Camera> cameras;
  for (const orbit::Vec direction : orbit::even_directions(kDirections))
    cameras.push_back(orbit::camera_at({ball.radius / intrinsics.least_half_sine() * direction, {0, 0, 0}}, intrinsics,
                                       frame, origin));
  return cameras;
}

UnseenSurface summed(const std::vector<std::vector<SurfacePixel>>& renders) {
  const std::vector<orbit::Vec> directions = orbit::even_directions(kDirections);
  UnseenSurface out;
  double all = 0;
  for (std::size_t d = 0; d < renders.size(); ++d) {
    const std::vector<SurfacePixel>& points = renders[d];
    const auto unseen = double(std::ranges::count(points, false, &SurfacePixel::seen));
    all += double(points.size());
    out.share += unseen;
    if (unseen > out.worst * double(points.size())) {
      out.worst = unseen / double(points.size());
      out.direction = directions[d];
    }
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
  const std::vector<Camera> around = cameras_around(ball, object.origin);
  const SplatOptions alone = prepared_for(exec, near_splat(ball.radius), object),
                     whole = prepared_for(exec, near_splat(ball.radius), input.cloud);
  std::vector<std::vector<SurfacePixel>> renders(around.size());
  const auto timed = monitor.scope("unseen surface");
  for_each_task(exec, std::int64_t(around.size()), [&](std::int64_t d) {
    renders[std::size_t(d)] = surface_pixels(object, around[std::size_t(d)], alone);
  });
  for (const Camera& camera : input.cameras) {
    SeeingView view(input.cloud, camera);
    std::vector<ForegroundBox> boxes(renders.size());
    for_each_task(exec, std::ssize(renders),
                  [&](std::int64_t d) { boxes[std::size_t(d)] = view.box_of(renders[std::size_t(d)]); });
    ForegroundBox box;
    for (const ForegroundBox& of_render : boxes) box.add(of_render);
    if (box.empty()) continue;
    view.render_window(
        box, [&](const Camera& window) { return depth_of(exec, input.cloud, window, whole, input.object.data()); });
    for_each_task(exec, std::ssize(renders),
                  [&](std::int64_t d) { view.mark_seen(kBehind * ball.radius, renders[std::size_t(d)]); });
  }
  return summed(renders);
}

}  // namespace ngs
