#include "ngs/edit/extract/unseen_surface.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/orbit/rigs.h"

namespace ngs {
namespace {

/// Opaque discs on the unit sphere, and on a floor below it.
struct BallCase {
  GaussianCloud cloud;
  std::vector<std::uint8_t> object;
  std::vector<Camera> cameras;
  Monitor monitor;

  void add(Vec3<double> at, Vec3<double> normal, double radius, bool is_object) {
    const auto i = std::size_t(cloud.size());
    cloud.resize(cloud.size() + 1, 0);
    cloud.position[3 * i] = float(at.x), cloud.position[3 * i + 1] = float(at.y),
                       cloud.position[3 * i + 2] = float(at.z);
    const double q[4] = {1 + normal.z, -normal.y, normal.x, 0};  // turns z to the normal
    for (std::size_t a = 0; a < 4; ++a) cloud.rotation[4 * i + a] = float(q[a]);
    cloud.logit_opacity[i] = 6, cloud.usable[i] = 1;
    for (std::size_t a = 0; a < 3; ++a) cloud.log_scale[3 * i + a] = float(std::log(a == 2 ? 0.1 * radius : radius));
    object.push_back(is_object);
  }
  /// The part of the sphere above `lowest`.
  explicit BallCase(double lowest) {
    for (const orbit::Vec at : orbit::even_directions(3000))
      if (at.z >= lowest) add(at, at, 0.05, true);
  }
  void add_floor(double z) {
    for (int y = -20; y <= 20; ++y)
      for (int x = -20; x <= 20; ++x) add({x * 0.15, y * 0.15, z}, {0, 0, 1}, 0.1, false);
  }
  /// A distant camera in a direction, from which nearly half of a sphere is visible.
  void look_from(Vec3<double> direction) {
    const orbit::Intrinsics intrinsics{200, 200, 8};
    cameras.push_back(orbit::camera_at({20.0 * unit(direction), {0, 0, 0}}, intrinsics, {}, cloud.origin));
  }
  UnseenSurface found() { return unseen_surface({}, monitor, {cloud, object, cameras}); }
};

TEST_CASE("one camera leaves half of a ball unseen, and nearly all of it from behind") {
  BallCase ball(-1);
  ball.look_from({0, 0, 1});
  const UnseenSurface found = ball.found();
  CHECK(found.share == doctest::Approx(0.5).epsilon(0.06));
  CHECK(found.worst > 0.95);
  CHECK(found.direction.z < -0.8);
}

TEST_CASE("six cameras around a ball leave no part of it unseen") {
  BallCase ball(-1);
  for (const double s : {-1.0, 1.0}) ball.look_from({s, 0, 0}), ball.look_from({0, s, 0}), ball.look_from({0, 0, s});
  const UnseenSurface found = ball.found();
  CHECK(found.share < 0.01);
}

TEST_CASE("occluders hide the object in the capture, although renders of the object alone do not contain them") {
  BallCase ball(-1);
  for (const double s : {-1.0, 1.0}) ball.look_from({s, 0, 1}), ball.look_from({0, s, 1});
  ball.look_from({0, 0, -1});
  CHECK(ball.found().share < 0.01);
  ball.add_floor(-1.3);
  const UnseenSurface found = ball.found();
  CHECK(found.share > 0.1);
  CHECK(found.direction.z < -0.8);
}

TEST_CASE("the inside of a shell is unseen if only its outside is visible in views") {
  BallCase shell(0);
  for (const double s : {-1.0, 1.0}) shell.look_from({s, 0, 1}), shell.look_from({0, s, 1});
  shell.look_from({0, 0, 1});
  const UnseenSurface found = shell.found();
  CHECK(found.share > 0.2);
  CHECK(found.worst > 0.9);
  CHECK(found.direction.z < -0.8);
}

TEST_CASE("an empty or unrendered object has no unseen surface; without cameras all of it is unseen") {
  BallCase ball(-1);
  CHECK(ball.found().share == 1);
  ball.object.assign(ball.object.size(), 0);
  CHECK(ball.found().share == 0);
  ball.object.assign(ball.object.size(), 1);
  for (float& logit : ball.cloud.logit_opacity) logit = -9;
  CHECK(ball.found().share == 0);
}

}  // namespace
}  // namespace ngs
