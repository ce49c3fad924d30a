#include "ngs/orbit/orbit_stage.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "support/error_code.h"
#include "support/splat_shapes.h"

namespace ngs::orbit {
namespace {

using test::add_box;
using test::add_floor;
using test::add_gaussian;
using test::add_sphere;
using test::transformed;

OrbitCameras cameras_of(const GaussianCloud& cloud, const OrbitOptions& options = {}, int threads = 2) {
  Monitor monitor;
  return choose_cameras({.threads = threads}, monitor, cloud, options, {160, 120});
}

ErrorCode refusal(const GaussianCloud& cloud, const OrbitOptions& options = {}) {
  return test::code_of([&] { cameras_of(cloud, options); });
}

GaussianCloud sphere() {
  GaussianCloud cloud;
  add_sphere(cloud, {5, -2, 1}, 1.5, 600);
  return cloud;
}

/// Sine of the angle between the camera's axis and the direction to `p`.
double off_axis(const Camera& camera, Vec p) {
  const Vec seen = unit(camera.rotation * p + camera.translation);
  return seen.z > 0 ? std::hypot(seen.x, seen.y) : 1;
}

}  // namespace

TEST_CASE("cameras look at the middle of an object from all around, and the object fills the image") {
  const OrbitCameras found = cameras_of(sphere());
  CHECK_FALSE(found.inside);
  CHECK(length(found.centre - Vec{5, -2, 1}) < 0.02);
  CHECK(found.radius == doctest::Approx(1.5).epsilon(0.12));  // with the Gaussians' own width
  REQUIRE(found.cameras.size() >= 24);
  Vec sum{0, 0, 0};
  for (const Camera& camera : found.cameras) {
    CHECK(off_axis(camera, {5, -2, 1}) < 0.01);
    const double distance = length(camera.centre() - Vec{5, -2, 1});
    const double filled = camera.fy * 1.5 / std::sqrt(distance * distance - 1.5 * 1.5) / 60;  // of half the height
    CHECK(filled > 0.8);
    CHECK(filled < 1);
    CHECK(-camera.rotation(1, 1) <= 0);  // the image's down is the world's +y: without a floor up is -y
    sum = sum + unit(camera.centre() - Vec{5, -2, 1});
  }
  CHECK(std::hypot(sum.x, sum.z) / double(found.cameras.size()) < 0.1);
  CHECK(found.coverage >= 0.95);
}

TEST_CASE("distant floaters change neither the target nor the distance of cameras") {
  GaussianCloud cloud = sphere();
  for (int k = 0; k < 6; ++k) add_gaussian(cloud, {400.0 + 100 * k, 300, -900}, 20);
  const OrbitCameras found = cameras_of(cloud);
  CHECK(length(found.centre - Vec{5, -2, 1}) < 0.05);
  CHECK(found.radius == doctest::Approx(1.5).epsilon(0.15));
}

TEST_CASE("up points away from a floor, for any rotation of the scene") {
  GaussianCloud cloud;
  add_floor(cloud, 3, 0, 0.1);
  add_sphere(cloud, {0, 0, 0.7}, 0.6, 500);
  add_box(cloud, {0.8, 0.4, 0}, {1.4, 1, 0.9}, 0.08);
  for (const auto& at : {std::array{0.3, 0.2, 0.9}, std::array{-1.0, 0.4, 0.1}, std::array{0.0, -1.0, 0.0}}) {
    const Vec up = unit({at[0], at[1], at[2]}), a = perpendicular(up), b = cross(up, a);
    const Mat3<double> turn{{a.x, b.x, up.x, a.y, b.y, up.y, a.z, b.z, up.z}};
    const OrbitCameras found = cameras_of(transformed(cloud, turn, 2, {1, 2, 3}));
    CAPTURE(at[0]);
    CHECK(found.up_is_guessed);
    CHECK(dot(found.up, up) > 0.998);                                                               // 3.6 degrees
    for (const Camera& camera : found.cameras) CHECK(dot(camera.centre() - Vec{1, 2, 3}, up) > 0);  // above the floor
  }
}

TEST_CASE("up of an object without a floor is -y, or the given axis") {
  CHECK_FALSE(cameras_of(sphere()).up_is_guessed);
  CHECK(cameras_of(sphere()).up.y == -1);
  const OrbitCameras found = cameras_of(sphere(), {.up = UpAxis::kMinusX, .around = {}});
  CHECK(found.up.x == -1);
  CHECK_FALSE(found.up_is_guessed);
}

TEST_CASE("cameras are placed inside a furnished room, and outside an equally hollow object") {
  const OrbitCameras room = cameras_of(test::furnished_room());
  CHECK(room.inside);
  for (const Camera& camera : room.cameras) {
    const Vec c = camera.centre();
    CHECK(std::abs(c.x) < 1.9);
    CHECK(std::abs(c.y) < 1.4);
    CHECK(c.z > 0.1);
    CHECK(c.z < 2.3);
  }
  CHECK(room.coverage >= 0.95);
  GaussianCloud hollow;
  add_box(hollow, {-2, -1.5, 0}, {2, 1.5, 2.4}, 0.1);
  CHECK_FALSE(cameras_of(hollow).inside);
  OrbitOptions options{.place = Place::kInside, .around = {}};
  CHECK(cameras_of(hollow, options).inside);
  options.place = Place::kOutside;
  CHECK_FALSE(cameras_of(test::furnished_room(), options).inside);
}

TEST_CASE("near cameras stand above what most Gaussians show, and an object alone is seen from all sides") {
  GaussianCloud cloud;
  add_floor(cloud, 5, 0, 0.25);
  for (const double x : {-1.0, 0.0, 1.0}) add_box(cloud, {x, 0, 0.02}, {x + 0.4, 0.4, 0.4}, 0.02);
  OrbitOptions options{.place = Place::kNear, .around = {}};
  const OrbitCameras found = cameras_of(cloud, options);
  CHECK(found.coverage >= 0.95);
  CHECK(found.radius < 1.3);
  for (const Camera& camera : found.cameras) {
    CHECK(camera.centre().z > 0);
    CHECK(length(camera.centre() - Vec{0.2, 0.2, 0.2}) < 5);
  }
  CHECK(length(cameras_of(cloud).cameras[0].centre() - Vec{0.2, 0.2, 0.2}) > 7);
  CHECK(cameras_of(sphere(), options).cameras[0].centre().x == cameras_of(sphere()).cameras[0].centre().x);
}

TEST_CASE("cameras around a ball in a large scene are placed in front of walls") {
  GaussianCloud cloud = test::furnished_room();
  add_sphere(cloud, {0.2, 0, 1.2}, 0.25, 400);
  const OrbitCameras found = cameras_of(cloud, {.up = UpAxis::kZ, .around = "0.2,0,1.2,0.3"});
  CHECK_FALSE(found.inside);
  CHECK(found.cameras.size() >= 12);
  for (const Camera& camera : found.cameras) {
    CHECK(off_axis(camera, {0.2, 0, 1.2}) < 0.01);
    CHECK(camera.centre().z > 0);
    CHECK(camera.centre().z < 2.4);
    CHECK(std::abs(camera.centre().y) < 1.5);
  }
}

TEST_CASE("cameras are added until the surface is covered, up to the limit") {
  GaussianCloud cloud;
  add_box(cloud, {-1, -1, -1}, {1, 1, 1}, 0.12);
  OrbitOptions options{.around = {}, .view_count = 3};
  const OrbitCameras found = cameras_of(cloud, options);
  CHECK(found.cameras.size() > 3);
  CHECK(found.coverage >= 0.95);
  options.max_views = 3;
  const OrbitCameras few = cameras_of(cloud, options);
  CHECK(few.cameras.size() == 3);
  CHECK(few.coverage < 0.95);
}

TEST_CASE("a model of one Gaussian, one point or one plane has cameras") {
  GaussianCloud one;
  add_gaussian(one, {1, 2, 3}, 0.5);
  const OrbitCameras found = cameras_of(one);
  CHECK(found.centre.x == doctest::Approx(1));
  CHECK(found.radius == doctest::Approx(1));
  CHECK(found.coverage == 1);
  GaussianCloud point;
  for (int k = 0; k < 20; ++k) add_gaussian(point, {1, 2, 3}, 0.5);
  CHECK(cameras_of(point).radius == doctest::Approx(1));
  GaussianCloud plane;
  add_floor(plane, 2, 0, 0.2);
  CHECK(cameras_of(plane).coverage >= 0.95);
}

TEST_CASE("an invisible model is an error; a tiny or a huge one is not") {
  GaussianCloud cloud = sphere();
  for (float& logit : cloud.logit_opacity) logit = -20;
  CHECK(refusal(cloud) == ErrorCode::kNothingFound);
  CHECK(refusal(GaussianCloud{}) == ErrorCode::kNothingFound);
  const Mat3<double> same{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  CHECK(cameras_of(sphere()).world_unit == 1);
  for (const double factor : {0.03, 1e-3, 1e-6}) {
    const OrbitCameras small = cameras_of(transformed(sphere(), same, factor, {0, 0, 0}));
    CHECK(0.2 * small.world_unit < small.radius);  // the near plane does not cut into it
    CHECK(small.world_unit > 0.01 * factor);
    CHECK(small.coverage >= 0.95);
  }
  const OrbitCameras huge = cameras_of(transformed(sphere(), same, 1e6, {0, 0, 0}));
  CHECK(huge.radius == doctest::Approx(1.5e6).epsilon(0.12));
  CHECK(huge.coverage >= 0.95);
}

TEST_CASE("a ball is four numbers with a radius above 0, and must contain a visible Gaussian") {
  for (const char* text :
       {"", "1,2,3", "1,2,3,0", "1,2,3,-1", "1,2,3,4,5", "1,2,x,4", "1,2,3,nan", "1,,3,4", "1,2,3,4,"})
    CHECK_THROWS_AS(parse_ball(text), Error);
  const Ball ball = parse_ball("1,-2.5,3e1,0.25");
  CHECK(ball.centre.y == -2.5);
  CHECK(ball.centre.z == 30);
  CHECK(ball.radius == 0.25);
  CHECK(refusal(sphere(), {.around = "50,50,50,1"}) == ErrorCode::kNothingFound);
}

TEST_CASE("the chosen cameras are the same for any number of threads") {
  const GaussianCloud room = test::furnished_room();
  const OrbitCameras one = cameras_of(room, {}, 1), three = cameras_of(room, {}, 3);
  REQUIRE(one.cameras.size() == three.cameras.size());
  CHECK(one.coverage == three.coverage);
  for (std::size_t i = 0; i < one.cameras.size(); ++i)
    CHECK(length(one.cameras[i].translation - three.cameras[i].translation) == 0);
}

}  // namespace ngs::orbit
