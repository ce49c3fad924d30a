
#include "ngs/orbit/free_space.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/orbit/coverage.h"
#include "ngs/orbit/rigs.h"
#include "support/cameras.h"
#include "support/splat_shapes.h"

namespace ngs::orbit {
namespace {

FreeSpace space_of(const GaussianCloud& cloud, double half, int cells = 64) {
  return FreeSpace(cloud, surface_points(cloud), Frame{}, {half, cells});
}

}  // namespace

TEST_CASE("rays end at a wall, and only there") {
  GaussianCloud cloud;
  test::add_floor(cloud, 2, -1, 0.1);
  const FreeSpace space = space_of(cloud, 2.5);
  CHECK(space.free_length({0.3, 0.2, 1}, {0, 0, -1}, {0.5, 9}) == doctest::Approx(2).epsilon(0.06));
  CHECK(space.free_length({0.3, 0.2, 1}, {0, 0, 1}, {0.5, 9}) == 9);
  CHECK(space.free_length({0.3, 0.2, 1}, {1, 0, 0}, {0.5, 9}) == 9);
  CHECK(space.cell_at({0, 0, 3}) == -1);
  CHECK(space.depth_at({0, 0, 3}) == 0);
}

TEST_CASE("one large Gaussian adds extinction to all cells that it covers") {
  GaussianCloud cloud;
  test::add_gaussian(cloud, {0, 0, 0}, 0.5);
  const FreeSpace space = space_of(cloud, 2);
  for (const double x : {0.0, 0.3, 0.6, -0.6}) CHECK(space.depth_at({x, 0.01, 0.01}) > 0);
  CHECK(space.depth_at({1, 0, 0}) == 0);
  // In total it absorbs 0.95 times the patch of area 2 pi 0.25 from light along any axis.
  double taken = 0;
  const double step = space.cell_size();
  for (double x = -2 + step / 2; x < 2; x += step)
    for (double y = -2 + step / 2; y < 2; y += step)
      for (double z = -2 + step / 2; z < 2; z += step) taken += space.depth_at({x, y, z}) * step * step;
  CHECK(taken == doctest::Approx(0.9526 * 6.2832 * 0.25).epsilon(1e-3));
}

TEST_CASE("a room shows more surface from inside, a hollow box the same, and a ball on a floor has no viewpoints") {
  GaussianCloud box, open;
  test::add_box(box, {-1, -1, -1}, {1, 1, 1}, 0.1);
  test::add_floor(open, 1, -0.6, 0.1);
  test::add_sphere(open, {0, 0, 0}, 0.5, 400);
  const RoomFinding hollow = find_room(Exec{}, space_of(box, 1.9), 1.7);
  CHECK_FALSE(hollow.viewpoints.empty());
  CHECK_FALSE(hollow.is_room());
  CHECK_FALSE(find_room(Exec{}, space_of(open, 1.9), 1.7).is_room());
  test::add_box(box, {-0.4, -0.4, -0.9}, {0.3, 0.3, 0}, 0.1);
  const RoomFinding room = find_room(Exec{}, space_of(box, 1.9), 1.7);
  CHECK(room.is_room());
  for (const Vec& viewpoint : room.viewpoints) {
    CHECK(std::max({std::abs(viewpoint.x), std::abs(viewpoint.y), std::abs(viewpoint.z)}) < 0.9);
    CHECK((viewpoint.x < -0.4 || viewpoint.x > 0.3 || viewpoint.y < -0.4 || viewpoint.y > 0.3 ||
           viewpoint.z > 0));  // not in the box
  }
}

TEST_CASE("a camera looks from its centre at its target, with the image's down away from up") {
  const Intrinsics intrinsics{80, 60, 50};
  const Frame frame{{1, 2, 3}, {{0, 1, 0, 0, 0, 1, 1, 0, 0}}};  // up is the world's x
  const Camera camera = camera_at({{2, 0.5, 1}, {0, 0, 0}}, intrinsics, frame, {10, 0, 0});
  const Vec world = frame.to_world({2, 0.5, 1}) + Vec{10, 0, 0};
  CHECK(length(camera.centre() - world) < 1e-12);
  const Vec seen = camera.rotation * (frame.centre + Vec{10, 0, 0}) + camera.translation;
  CHECK(std::hypot(seen.x, seen.y) < 1e-12);
  CHECK(seen.z == doctest::Approx(length({2, 0.5, 1})));
  CHECK(camera.rotation(1, 0) < 0);                // down is not up
  CHECK(std::abs(camera.rotation(0, 0)) < 1e-12);  // the horizon is level
  CHECK(2 * std::atan(40 / camera.fx) == doctest::Approx(50 * 3.14159265358979 / 180));
  const Camera above = camera_at({{0, 0, 2}, {0, 0, 0}}, intrinsics, frame, {0, 0, 0});
  CHECK(length(above.rotation * Vec{1, 0, 0} - Vec{0, 0, -1}) < 1e-12);  // straight down
}

TEST_CASE("coverage is the weight of points that three views show, among points that any candidate shows") {
  // Five points of weight 1, 2, 3, 4 and 100; the last one is visible from no candidate.
  const std::vector<Visibility> pool = {{{0, 1, 2}, {0, 1, 2}, 0}, {{0, 1}, {0, 1}, 0}, {{0, 3}, {3}, 0}};
  Coverage coverage({1, 2, 3, 4, 100}, pool);
  CHECK(coverage.gaussians() == 4);
  CHECK(coverage.share() == 0);
  CHECK(coverage.gain(pool[0]) == 6);
  coverage.add(pool[0]);
  coverage.add(pool[1]);
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
  const Camera camera = test::camera_along_z(64, 48, 60);
  const Visibility visibility = renderer.of(Exec{}, camera, 2.5);
  CHECK(visibility.shown == std::vector<std::uint32_t>{1});
  CHECK(visibility.surface == std::vector<std::uint32_t>{1});
  CHECK(visibility.blocked > 0.5);
  CHECK(renderer.of(Exec{}, camera, 1.5).blocked == 0);  // nothing is nearer than that
}

}  // namespace ngs::orbit
