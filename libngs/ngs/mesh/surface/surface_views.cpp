#include "ngs/mesh/surface/surface_views.h"

#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/math/quat.h"
#include "ngs/math/world_unit.h"
#include "ngs/orbit/rigs.h"

namespace ngs::mesh {
namespace {

using Vec = Vec3<double>;

constexpr double kFov_deg = 30;
constexpr double kWall = 0.04;        // radii of the ball: both sides of a thinner wall count as one surface
constexpr double kOneSided = 2;       // minimum ratio of views of a shell from outside to views from inside
constexpr double kLeastSlope = 0.2;   // cosine: limits the shift along a ray
constexpr float kOpaque = 0.5f;       // least alpha of a pixel that shows the surface
constexpr double kLeastScale = 0.05;  // of a Gaussian's largest standard deviation: limits the tilt of its plane
constexpr double kFront = 1.5;        // the surface is this many standard deviations of the layers before their mean
// Label channels. The rendering sums them with the weights of the pixel's Gaussians.
constexpr int kNormal = 0;   // n, 3
constexpr int kOffset = 3;   // n · (m - eye)
constexpr int kWithin = 4;   // 1: seen from within
constexpr int kBehind = 5;   // distance of m behind the surface of the first pass
constexpr int kSquared = 6;  // its square, and the variance along n
constexpr int kChannels = 7;

/// Results of the first pass, at half the size, for the second pass.
struct FirstPass {
  std::vector<SurfaceView> views;
  std::vector<Vec> outward;  // [N], see outward_directions()
};

/// The ray of a pixel, camera z 1, world axes.
Vec ray_of(const Camera& camera, double x_px, double y_px) {
  return transpose(camera.rotation) * Vec{(x_px - camera.cx) / camera.fx, (y_px - camera.cy) / camera.fy, 1};
}

Vec centre_of(const GaussianCloud& cloud, std::size_t i) {
  const float* p = &cloud.position[3 * i];
  return {double(p[0]), double(p[1]), double(p[2])};
}

/// The distance of a point behind the surface of a view, world, at most `most` either way; 0: no surface there.
double behind_surface(const SurfaceView& view, Vec point, double most) {
  const std::optional<Vec> at = view.camera.project(point);
  if (!at) return 0;
  const std::size_t pixel = view.depth.index(int(at->x), int(at->y));
  if (!(view.depth.data[pixel] > 0)) return 0;
  const auto& n = view.normal[pixel];
  const Vec normal = transpose(view.camera.rotation) * Vec{n[0] / 127.0, n[1] / 127.0, n[2] / 127.0};
  return std::clamp(dot(normal, view.point(pixel) - point), -most, most);
}

/// The plane of a Gaussian as seen along `offset`, from the eye to its centre.
struct TangentPlane {
  Vec normal;
  double deviation;  // standard deviation along the normal, between tangent planes
};
TangentPlane tangent_plane(const GaussianCloud& cloud, std::size_t i, Vec offset) {
  const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * i]);
  const float* log_scale = &cloud.log_scale[3 * i];
  const double largest = std::exp(double(*std::max_element(log_scale, log_scale + 3)));
  const Vec along = transpose(axes) * unit(offset);
  const auto variance = [&](float log_scale_k) {
    const double deviation = std::max(std::exp(double(log_scale_k)), kLeastScale * largest);
    return deviation * deviation;
  };
  const Vec over{1 / variance(log_scale[0]), 1 / variance(log_scale[1]), 1 / variance(log_scale[2])};
  const Vec normal = unit(Vec{-along.x * over.x, -along.y * over.y, -along.z * over.z});
  const double curvature = dot(normal, Vec{normal.x * over.x, normal.y * over.y, normal.z * over.z});
  return {axes * normal, 1 / std::sqrt(curvature)};
}

/// [N, kChannels] The label channels of every Gaussian as seen from a camera.
std::vector<float> channels_of(const GaussianCloud& cloud, const Camera& camera, const FirstPass& first, std::size_t v,
                               double wall) {
  const Vec eye = camera.centre();
  std::vector<float> channels(std::size_t(cloud.size()) * kChannels);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    if (!cloud.usable[i]) continue;
    const Vec centre = centre_of(cloud, i), offset = centre - eye;
    const TangentPlane plane = tangent_plane(cloud, i, offset);
    float* row = &channels[i * kChannels];
    row[kNormal] = float(plane.normal.x);
    row[kNormal + 1] = float(plane.normal.y);
    row[kNormal + 2] = float(plane.normal.z);
    row[kOffset] = float(dot(plane.normal, offset));
    if (first.views.empty()) continue;
    const double behind = behind_surface(first.views[v], centre, wall);
    row[kWithin] = dot(first.outward[i], offset) > 0 ? 1.f : 0.f;
    row[kBehind] = float(behind);
    row[kSquared] = float(behind * behind + plane.deviation * plane.deviation);
  }
  return channels;
}

std::uint8_t byte_of(float value) { return std::uint8_t(std::clamp(value * 255.f + 0.5f, 0.f, 255.f)); }

void store_pixel(const RenderedView& rendered, std::size_t pixel, Vec ray, SurfaceView& view) {
  const float alpha = rendered.alpha.data[pixel];
  view.alpha.data[pixel] = byte_of(alpha);
  if (!(alpha >= kOpaque)) return;
  const float* row = &rendered.label.data[pixel * kChannels];
  const Vec sum{double(row[kNormal]), double(row[kNormal + 1]), double(row[kNormal + 2])};
  const Vec normal = view.camera.rotation * unit(sum);
  const double slope = dot(sum, ray);
  const double mean = double(row[kBehind] / alpha);
  const double deviation = std::sqrt(std::max(double(row[kSquared] / alpha) - mean * mean, 0.0));
  const double depth = double(row[kOffset]) / slope - kFront * deviation / std::max(-dot(unit(sum), ray), kLeastSlope);
  if (!(slope < 0 && depth > 0 && std::isfinite(depth))) return;
  if (row[kWithin] > 0.5f * alpha) {
    view.depth.data[pixel] = kSeenFromWithin;
    return;
  }
  view.depth.data[pixel] = float(depth);
  const auto scaled = [](double v) { return std::int8_t(std::lround(127 * v)); };
  view.normal[pixel] = {scaled(normal.x), scaled(normal.y), scaled(normal.z)};
  for (std::size_t c = 0; c < 3; ++c)
    view.colour.data[3 * pixel + c] = byte_of(rendered.colour.data[3 * pixel + c] / alpha);
}

class Renderer {
 public:
  Renderer(const Exec& exec, const GaussianCloud& cloud, const SurfaceRig& rig)
      : exec_(exec), cloud_(cloud), rig_(rig) {
    SplatOptions splat;
    splat.compat = Compat::kGsplat;  // for its nearer near plane
    splat.antialiased = cloud.antialiased;
    splat.world_unit = world_unit_for(distance() - rig.ball.radius, near_plane(Compat::kGsplat));
    splat_ = prepared_for(exec, splat, cloud);
  }

  std::vector<SurfaceView> views(int side_px, const FirstPass& first) const {
    std::vector<SurfaceView> views(rig_.directions.size());
    for_each_task(exec_, std::ssize(views), [&](std::int64_t v) {
      const orbit::Pose pose{distance() * rig_.directions[std::size_t(v)], {0, 0, 0}};
      const Camera camera =
          orbit::camera_at(pose, {side_px, side_px, kFov_deg}, {.centre = rig_.ball.centre}, cloud_.origin);
      views[std::size_t(v)] = view(camera, first, std::size_t(v));
    });
    return views;
  }

 private:
  double distance() const { return rig_.ball.radius / orbit::Intrinsics{1, 1, kFov_deg}.least_half_sine(); }

  SurfaceView view(const Camera& camera, const FirstPass& first, std::size_t v) const {
    SurfaceView view;
    view.camera = relative_to(camera, cloud_.origin);
    const std::vector<float> channels = channels_of(cloud_, view.camera, first, v, kWall * rig_.ball.radius);
    RenderRequest request;
    request.label = {channels.data(), cloud_.size(), kChannels};
    const RenderedView rendered = render(exec_.one_thread(), cloud_, camera, splat_, request);
    view.alpha = ImageU8(camera.width_px, camera.height_px, 1);
    view.depth = ImageF(camera.width_px, camera.height_px, 1);
    view.colour = ImageU8(camera.width_px, camera.height_px, 3);
    view.normal.resize(std::size_t(view.depth.pixels()));
    for (int y = 0; y < camera.height_px; ++y)
      for (int x = 0; x < camera.width_px; ++x)
        store_pixel(rendered, view.depth.index(x, y), ray_of(view.camera, x + 0.5, y + 0.5), view);
    return view;
  }

  const Exec& exec_;
  const GaussianCloud& cloud_;
  const SurfaceRig& rig_;
  SplatOptions splat_;
};

/// [N] Unit direction from which views see a Gaussian. 0: no view sees it, or views see it from both sides, as with a
/// leaf. Both sides of a wall thinner than `wall` count as one surface.
std::vector<Vec> outward_directions(const Exec& exec, const GaussianCloud& cloud, const std::vector<SurfaceView>& views,
                                    double wall) {
  std::vector<Vec> outward(std::size_t(cloud.size()), Vec{0, 0, 0});
  for_each_index(exec, cloud.size(), [&](std::int64_t i) {
    if (!cloud.usable[std::size_t(i)]) return;
    const Vec centre = centre_of(cloud, std::size_t(i));
    std::vector<Vec> seen_from;
    Vec sum{0, 0, 0};
    for (const SurfaceView& view : views) {
      const std::optional<Vec> at = view.camera.project(centre);
      if (!at) continue;
      const auto depth = double(view.depth.at(int(at->x), int(at->y)));
      if (!(depth > 0) || std::abs(depth - at->z) > wall) continue;
      seen_from.push_back(unit(view.camera.centre() - centre));
      sum = sum + seen_from.back();
    }
    const Vec axis = unit(sum);
    double front = 0, back = 0;
    for (const Vec direction : seen_from) {
      const double cosine = dot(axis, direction);
      (cosine > 0 ? front : back) += std::abs(cosine);
    }
    if (front > kOneSided * back) outward[std::size_t(i)] = axis;
  });
  return outward;
}

}  // namespace

Vec SurfaceView::point(std::size_t pixel) const {
  const auto width = std::size_t(camera.width_px);
  const std::size_t x = pixel % width;
  const std::size_t y = pixel / width;
  return camera.centre() + double(depth.data[pixel]) * ray_of(camera, double(x) + 0.5, double(y) + 0.5);
}

std::vector<SurfaceView> render_surface_views(const Exec& exec, const GaussianCloud& cloud, const SurfaceRig& rig) {
  const Renderer renderer(exec, cloud, rig);
  FirstPass first{renderer.views((rig.side_px + 1) / 2, {}), {}};
  first.outward = outward_directions(exec, cloud, first.views, kWall * rig.ball.radius);
  return renderer.views(rig.side_px, first);
}

}  // namespace ngs::mesh
