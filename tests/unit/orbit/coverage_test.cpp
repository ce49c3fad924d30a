#include "ngs/orbit/coverage.h"

#include <doctest/doctest.h>

#include "support/splat_shapes.h"

namespace ngs::orbit {
namespace {

/// At the origin, looking along +z.
Camera camera_along_z() {
  Camera camera;
  camera.name = "test.png";
  camera.width_px = 64, camera.height_px = 48;
  camera.fx = camera.fy = 60, camera.cx = 32, camera.cy = 24;
  camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  return camera;
}

}  // namespace

TEST_CASE("coverage is the weight of points that three views show, among points that any candidate shows") {
  // Five points of weight 1, 2, 3, 4 and 100; the last one is visible from no candidate.
  const std::vector<Visibility> pool = {{{0, 1, 2}, {0, 1, 2}, 0}, {{0, 1}, {0, 1}, 0}, {{0, 3}, {3}, 0}};
  Coverage coverage({1, 2, 3, 4, 100}, pool);
  CHECK(coverage.gaussians() == 4);
  CHECK(coverage.share() == 0);
  CHECK(coverage.gain(pool[0]) == 6);
  coverage.add(pool[0]), coverage.add(pool[1]);
  CHECK(coverage.share() == 0);
  CHECK(coverage.gain(pool[2]) == 5);
  coverage.add(pool[2]);
  CHECK(coverage.share() == doctest::Approx(0.1));  // the point of weight 1 has three views
  CHECK(coverage.gain(pool[2]) == 4);
  coverage.add(pool[0]);
  CHECK(coverage.share() == doctest::Approx(0.3));
  for (int k = 0; k < 300; ++k) coverage.add(pool[0]);  // counters do not wrap
  CHECK(coverage.share() == doctest::Approx(0.6));
}

TEST_CASE("coverage of a surface that is visible from no candidate is 1") {
  CHECK(Coverage({1, 2}, {}).share() == 1);
  CHECK(Coverage({}, {}).share() == 1);
}

TEST_CASE("a point behind opaque Gaussians is not shown, a point next to them is") {
  GaussianCloud cloud;
  for (int k = 0; k < 6; ++k) test::add_gaussian(cloud, {0, 0, 2 + 0.01 * k}, 0.1);  // opaque together
  test::add_gaussian(cloud, {0, 0, 3}, 0.05);
  test::add_gaussian(cloud, {0.6, 0, 3}, 0.05);
  test::add_gaussian(cloud, {0, 0, -3}, 0.05);  // behind the camera
  const std::vector<std::int32_t> point_of_row = {-1, -1, -1, -1, -1, -1, 0, 1, 2};
  const PointVisibility renderer(Exec{}, cloud, point_of_row);
  const Visibility visibility = renderer.of(Exec{}, camera_along_z(), 2.5);
  CHECK(visibility.shown == std::vector<std::uint32_t>{1});
  CHECK(visibility.surface == std::vector<std::uint32_t>{1});
  CHECK(visibility.blocked > 0.5);
  CHECK(renderer.of(Exec{}, camera_along_z(), 1.5).blocked == 0);  // nothing is nearer than that
}

}  // namespace ngs::orbit
