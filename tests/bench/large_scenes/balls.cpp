#include "large_scenes/balls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "large_scenes/written_scene.h"
#include "ngs/core/error.h"
#include "ngs/math/sh.h"

namespace ngs::bench {
namespace {

using V = Vec3<double>;

constexpr double kRadius = 0.35, kFloorShare = 0.1;  // ball centres are one unit apart
constexpr V kSun{0.48, 0.6, 0.64};

/// Balls 0 .. balls - 1 on a checkered floor.
class BallScene {
 public:
  explicit BallScene(int balls) : balls_(balls), side_(int(std::ceil(std::sqrt(double(balls))))) {}

  int balls() const { return balls_; }
  double width() const { return side_; }
  V centre(int ball) const {
    const int column = ball % side_, row = ball / side_;
    return {column - 0.5 * (side_ - 1), kRadius, row - 0.5 * (side_ - 1)};
  }
  static V colour(int ball) {
    const auto part = [&](double turn) { return 0.25 + 0.5 * std::fmod(ball * turn, 1.0); };
    return {part(0.618), part(0.414), part(0.732)};
  }
  V floor_colour(const V& at) const {
    const bool dark = (int(std::floor(at.x * 2)) + int(std::floor(at.z * 2))) % 2 != 0;
    return dark ? V{0.3, 0.3, 0.32} : V{0.7, 0.7, 0.66};
  }
  static V lit(const V& colour, const V& normal) { return (0.5 + 0.5 * std::max(0.0, dot(normal, kSun))) * colour; }

  /// First hit of a ray: ball index, -1: floor, -2: none; `at` is the hit point.
  int first_hit(const V& from, const V& along, V& at) const {
    double nearest = INFINITY;
    int hit = -2;
    if (along.y < 0) {
      nearest = -from.y / along.y, hit = -1;
      at = from + nearest * along;
      if (std::max(std::abs(at.x), std::abs(at.z)) > 0.5 * width()) nearest = INFINITY, hit = -2;
    }
    for (int ball = 0; ball < balls_; ++ball) {
      const V to = centre(ball) - from;
      const double middle = dot(to, along), left = middle * middle - dot(to, to) + kRadius * kRadius;
      if (left <= 0 || middle - std::sqrt(left) >= nearest) continue;
      nearest = middle - std::sqrt(left), hit = ball;
    }
    if (hit >= 0) at = from + nearest * along;
    return hit;
  }

 private:
  int balls_, side_;
};

void add(GaussianCloud& cloud, const V& at, double sigma, const V& colour) {
  for (const double x : {at.x, at.y, at.z})
    cloud.position.push_back(float(x)), cloud.log_scale.push_back(float(std::log(sigma)));
  for (const float q : {1.f, 0.f, 0.f, 0.f}) cloud.rotation.push_back(q);
  cloud.logit_opacity.push_back(3.f);
  for (const double c : {colour.x, colour.y, colour.z}) cloud.sh_dc.push_back(float(dc_of_colour(c)));
  cloud.usable.push_back(1);
}

GaussianCloud cloud_of(const BallScene& scene, double gaussians) {
  const auto each = std::int64_t(gaussians * (1 - kFloorShare) / scene.balls());
  const auto line = std::int64_t(std::sqrt(gaussians * kFloorShare));
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  GaussianCloud cloud;
  for (std::int64_t i = 0; i < each; ++i)
    for (int ball = 0; ball < scene.balls(); ++ball) {
      const double y = 1 - (2 * double(i) + 1) / double(each), r = std::sqrt(1 - y * y), turn = golden * double(i);
      const V normal{r * std::cos(turn), y, r * std::sin(turn)};
      const double sigma = 0.5 * kRadius * std::sqrt(4 * std::numbers::pi / double(each));
      add(cloud, scene.centre(ball) + (kRadius - sigma) * normal, sigma,
          BallScene::lit(BallScene::colour(ball), normal));
    }
  for (std::int64_t i = 0; i < line * line; ++i) {
    const double step = scene.width() / double(line);
    const std::int64_t column = i % line, row = i / line;
    const V at{(double(column) + 0.5) * step - 0.5 * scene.width(), -0.5 * step,
               (double(row) + 0.5) * step - 0.5 * scene.width()};
    add(cloud, at, 0.5 * step, BallScene::lit(scene.floor_colour(at), {0, 1, 0}));
  }
  return cloud;
}

/// Camera on a ring around the scene, looking at its centre from above.
Camera camera_at(const BallScene& scene, const BallsOptions& options, int view) {
  const double turn = 2 * std::numbers::pi * view / options.views, reach = 0.8 * scene.width();
  const V from{reach * std::cos(turn), (0.45 + 0.2 * (view % 3)) * scene.width(), reach * std::sin(turn)};
  const V forward = unit(V{0, 0, 0} - from), right = unit(cross(forward, V{0, 1, 0})), down = cross(forward, right);
  Camera camera;
  camera.name = view_name(std::size_t(view));
  camera.width_px = options.width_px, camera.height_px = options.height_px;
  camera.fx = camera.fy = 0.9 * options.width_px;
  camera.cx = 0.5 * options.width_px, camera.cy = 0.5 * options.height_px;
  camera.rotation = {{right.x, right.y, right.z, down.x, down.y, down.z, forward.x, forward.y, forward.z}};
  camera.translation = -1.0 * (camera.rotation * from);
  return camera;
}

LabelledPhoto picture_of(const BallScene& scene, const Camera& camera) {
  LabelledPhoto made{ImageU8(camera.width_px, camera.height_px, 3), ImageU8(camera.width_px, camera.height_px, 1)};
  const Mat3<double> to_world = transpose(camera.rotation);
  const V from = camera.centre();
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      const V seen{(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1};
      V at{}, colour{};
      const int hit = scene.first_hit(from, unit(to_world * seen), at);
      if (hit >= 0) colour = BallScene::lit(BallScene::colour(hit), (1 / kRadius) * (at - scene.centre(hit)));
      if (hit == -1) colour = BallScene::lit(scene.floor_colour(at), {0, 1, 0});
      made.label.at(x, y) = std::uint8_t(hit + 1 > 0 ? hit + 1 : 0);
      const std::array<double, 3> rgb{colour.x, colour.y, colour.z};
      for (int c = 0; c < 3; ++c) made.rgb.at(x, y, c) = std::uint8_t(std::lround(255 * rgb[std::size_t(c)]));
    }
  return made;
}

}  // namespace

void write_balls(const BallsOptions& options, const std::string& folder) {
  if (options.balls < 1 || options.balls > 255)
    throw Error(ErrorCode::kUsage, std::to_string(options.balls) + " balls, expected 1 to 255");
  const BallScene scene(options.balls);
  std::vector<WrittenView> views;
  for (int v = 0; v < options.views; ++v) views.push_back({camera_at(scene, options, v), std::size_t(v)});
  write_scene(folder, cloud_of(scene, options.gaussians), views,
              [&](std::size_t picture) { return picture_of(scene, views[picture].camera); });
}

}  // namespace ngs::bench
