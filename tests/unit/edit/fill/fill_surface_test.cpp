#include "ngs/edit/fill/fill_surface.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/hole_scene.h"

namespace ngs {
namespace {

using test::HoleModel;

std::vector<FillSurface> surfaces_of(const HoleModel& model, FillKind kind = FillKind::kAuto) {
  return find_fill_surfaces({}, model.cloud, find_rim({}, model.cloud, model.object), kind, 0);
}

HoleModel on_dome() {
  HoleModel model;
  const auto height = [](double x, double y) { return -0.35 * (x * x + y * y); };
  const auto under = [](double x, double y) { return x * x + y * y < 0.07; };
  model.add_floor(
      height, [](double, double) { return 0.0; }, under);
  model.add_block({-0.2, -0.2, 0.04}, {0.2, 0.2, 0.6});
  return model;
}

}  // namespace

TEST_CASE("a block on a floor has one plane, whose normal points to the block") {
  const std::vector<FillSurface> found = surfaces_of(HoleModel::on_floor());
  REQUIRE(found.size() == 1);
  CHECK(found[0].relief.empty());
  CHECK(found[0].normal.z == doctest::Approx(1).epsilon(1e-6));
  CHECK(found[0].height({0.3, 0.2, 0.25}) == doctest::Approx(0.25).epsilon(1e-6));
  CHECK(found[0].spacing == doctest::Approx(0.05).epsilon(0.3));
}

TEST_CASE("a block in a corner has the floor and the wall") {
  const std::vector<FillSurface> found = surfaces_of(HoleModel::in_corner());
  REQUIRE(found.size() == 2);
  const std::size_t wall = found[0].normal.z > 0.5 ? 1 : 0;
  CHECK(found[wall].normal.y == doctest::Approx(1).epsilon(1e-4));
  CHECK(found[1 - wall].normal.z == doctest::Approx(1).epsilon(1e-4));
}

TEST_CASE("on curved ground auto takes a surface, whose residual is far below that of planes") {
  const HoleModel model = on_dome();
  const std::vector<FillSurface> curved = surfaces_of(model), planes = surfaces_of(model, FillKind::kPlane);
  REQUIRE(curved.size() == 1);
  CHECK_FALSE(curved[0].relief.empty());
  CHECK(curved[0].residual < 0.2 * curved[0].spacing);
  for (const FillSurface& plane : planes) CHECK(curved[0].rim_points > plane.rim_points);
  for (const double x : {0.0, 0.1, -0.2}) {
    const orbit::Vec ground{x, 0.1, -0.35 * (x * x + 0.01)};
    CHECK(std::abs(curved[0].height(ground)) < 0.01);
    for (const FillSurface& plane : planes) CHECK(std::abs(curved[0].height(ground)) < std::abs(plane.height(ground)));
  }
}

TEST_CASE("rims of 0, 1 and 2 points, and points on one line or at one place, have no surface") {
  for (const int count : {0, 1, 2, 40}) {
    HoleModel line, place;
    for (int i = 0; i < count; ++i)
      line.add({-0.4 + 0.02 * i, 0.32, 0}, 2, 0, false), place.add({0, 0.35, 0}, 2, 0, false);
    line.add_block({-0.3, -0.3, 0}, {0.3, 0.3, 0.6}), place.add_block({-0.3, -0.3, 0}, {0.3, 0.3, 0.6});
    CAPTURE(count);
    for (const FillKind kind : {FillKind::kAuto, FillKind::kPlane, FillKind::kSurface}) {
      CHECK(surfaces_of(line, kind).empty());
      CHECK(surfaces_of(place, kind).empty());
    }
  }
}

TEST_CASE("a plane through the middle of the object is no surface that it stands on") {
  HoleModel model;
  const auto inside = [](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 0.32; };
  model.add_floor([](double, double) { return 0.3; }, [](double, double) { return 0.0; }, inside);
  model.add_block({-0.3, -0.3, 0}, {0.3, 0.3, 0.6});
  CHECK(surfaces_of(model, FillKind::kPlane).empty());
}

}  // namespace ngs
