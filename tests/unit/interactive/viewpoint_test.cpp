#include "ngs/interactive/viewpoint.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/ops/splat/splat.h"
#include "support/splat_shapes.h"

namespace ngs {

TEST_CASE("the camera of a viewpoint has look_at at its middle pixel and up upwards") {
  live::Viewpoint viewpoint{{1, 2, 3}, {4, 0, -2}, {0, 0, 1}, 60, 320, 240};
  const Camera camera = live::camera_of(viewpoint);
  const auto pixel = [&](Vec3<double> p) {
    const Vec3<double> at = camera.rotation * p + camera.translation;
    REQUIRE(at.z > 0);
    return Vec2<double>{camera.fx * at.x / at.z + camera.cx, camera.fy * at.y / at.z + camera.cy};
  };
  const Vec2<double> middle = pixel(viewpoint.look_at), above = pixel(viewpoint.look_at + Vec3<double>{0, 0, 0.1});
  CHECK(middle.x == doctest::Approx(160));
  CHECK(middle.y == doctest::Approx(120));
  CHECK(above.y < middle.y);
  CHECK(above.x == doctest::Approx(160));
  CHECK(std::atan(120 / camera.fy) == doctest::Approx(30 * 3.14159265358979 / 180));
  viewpoint.up = viewpoint.look_at - viewpoint.position;
  CHECK(std::isfinite(live::camera_of(viewpoint).rotation(0, 0)));
  viewpoint.look_at = viewpoint.position;
  CHECK_THROWS_AS(live::camera_of(viewpoint), Error);
}

TEST_CASE("the first viewpoint at a model shows the model") {
  GaussianCloud cloud;
  test::add_sphere(cloud, {3, -1, 7}, 0.5, 700);
  const live::InitialViewpoint first = live::initial_viewpoint({}, cloud);
  const Vec3<double> off = first.centre - Vec3<double>{3, -1, 7};
  CHECK(std::sqrt(dot(off, off)) < 0.1);
  CHECK(first.radius == doctest::Approx(0.5).epsilon(0.3));
  const RenderedView view = render({}, cloud, live::camera_of(first.viewpoint), {.world_unit = first.world_unit}, {});
  double covered = 0;
  for (const float alpha : view.alpha.data) covered += double(alpha) / double(view.alpha.data.size());
  CHECK(covered > 0.1);
  CHECK_THROWS_AS(live::initial_viewpoint({}, GaussianCloud()), Error);
}

}  // namespace ngs
