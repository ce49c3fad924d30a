#include "ngs/make/synth/synth_halves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "ngs/core/error.h"
#include "ngs/math/vectors.h"

namespace ngs::synth {
namespace {

using V = Vec3<double>;
constexpr double kRadPerDeg = std::numbers::pi / 180, kGoldenAngle = 2.399963229728653;
constexpr double kClearance = 0.3;  // world: beyond the near plane of 0.2 of the Inria renderer

std::string two_digits(int i) { return (i < 10 ? "0" : "") + std::to_string(i); }

V direction_of(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

bool is_clear(const AnalyticScene& scene, V p) {
  const V a = p - scene.room.low, b = scene.room.high - p;
  if (std::min({a.x, a.y, a.z, b.x, b.y, b.z}) < kClearance) return false;
  for (const Object& object : scene.objects)
    for (const Solid& solid : object.solids)
      if (signed_distance(solid, p) < kClearance) return false;
  return true;
}

struct Shell {
  const char* name;
  V centre;
  double radius, low_deg, high_deg;  // elevations
};

/// The first kHoleViews clear places of an even sequence over the shell.
void add_cameras(const Recipe& recipe, const AnalyticScene& scene, const Shell& shell, std::vector<Camera>& cameras) {
  constexpr int kTries = 2000;
  int found = 0;
  for (int i = 0; i < kTries && found < kHoleViews; ++i) {
    const double part = std::fmod(0.5 + 0.7548776662 * i, 1.0);
    const double elevation = (shell.low_deg + (shell.high_deg - shell.low_deg) * part) * kRadPerDeg;
    const V place = shell.centre + shell.radius * direction_of(kGoldenAngle * i, elevation);
    if (!is_clear(scene, place)) continue;
    Camera camera = recipe_camera(recipe);
    camera.name = std::string(shell.name) + "-" + two_digits(found++) + ".png";
    look_at(camera, place, shell.centre);
    cameras.push_back(camera);
  }
  if (found < kHoleViews)
    throw Error(ErrorCode::kUsage,
                "target: \"" + scene.objects[std::size_t(scene.target)].name + "\" has " + std::to_string(found) +
                    " places for cameras " + shell.name + " it, expected " + std::to_string(kHoleViews),
                "choose a smaller --target, or --truth masks");
}

}  // namespace

AnalyticScene without_target(AnalyticScene scene) {
  scene.objects[std::size_t(scene.target)].solids.clear();
  return scene;
}

AnalyticScene target_alone(AnalyticScene scene) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) scene.objects[i].visible = int(i) == scene.target;
  scene.has_room = false;
  return scene;
}

TargetBall target_ball(const AnalyticScene& scene) {
  const std::vector<Solid>& solids = scene.objects[std::size_t(scene.target)].solids;
  V low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const Solid& s : solids) {
    const double r = s.bound_radius;
    low = {std::min(low.x, s.centre.x - r), std::min(low.y, s.centre.y - r), std::min(low.z, s.centre.z - r)};
    high = {std::max(high.x, s.centre.x + r), std::max(high.y, s.centre.y + r), std::max(high.z, s.centre.z + r)};
  }
  TargetBall ball{0.5 * (low + high), 0};
  for (const Solid& s : solids) ball.radius = std::max(ball.radius, length(s.centre - ball.centre) + s.bound_radius);
  return ball;
}

std::vector<Camera> target_rig(const Recipe& recipe, const AnalyticScene& scene) {
  const TargetBall ball = target_ball(scene);
  const Camera blank = recipe_camera(recipe);
  const double half_fov = std::atan(0.5 * std::min(blank.width_px, blank.height_px) / blank.fx);
  const double distance = std::max(scene.rig_radius, 1.05 * ball.radius / std::sin(half_fov));
  std::vector<Camera> cameras;
  for (const V& direction : orbit::even_directions(kTargetViews)) {
    Camera camera = blank;
    camera.name = "00" + two_digits(int(cameras.size())) + ".png";
    look_at(camera, ball.centre + distance * direction, ball.centre);
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<Camera> hole_rig(const Recipe& recipe, const AnalyticScene& scene) {
  const TargetBall ball = target_ball(scene);
  std::vector<Camera> cameras;
  add_cameras(recipe, scene, {"above", ball.centre, 0.9 * scene.rig_radius, 60, 80}, cameras);
  const double near = std::max(1.6 * ball.radius, 0.25 * scene.rig_radius);
  add_cameras(recipe, scene, {"near", ball.centre, near, 20, 50}, cameras);
  return cameras;
}

}  // namespace ngs::synth
