#include "ngs/edit/fill/fill_surface.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "ngs/core/rng.h"
#include "ngs/edit/fill/fill_texture.h"
#include "ngs/edit/fill/rim.h"
#include "ngs/edit/fill/thin_plate.h"
#include "support/hole_scene.h"

namespace ngs {

TEST_CASE("a rim has the object without stray Gaussians, and solid Gaussians near it without needles") {
  test::HoleModel model = test::HoleModel::on_floor();
  const std::size_t all = std::size_t(std::count(model.object.begin(), model.object.end(), 1));
  model.add({50, 0, 0}, -1, 1, true);      // stray
  model.add({0.4, 0, 0.1}, -1, 0, false);  // a needle
  model.cloud.log_scale[3 * (model.object.size() - 1)] = std::log(1.f);
  model.add({0.4, 0.1, 0.1}, -1, 0, false);  // half-transparent
  model.cloud.logit_opacity.back() = -0.5f;
  model.add({0, 0, 30}, -1, 0, false);  // far away
  const Rim rim = find_rim({}, model.cloud, model.object);
  CHECK(rim.object.count() == all);
  CHECK(rim.box.high.z == doctest::Approx(0.6));
  CHECK(rim.box.low.x == doctest::Approx(-0.3));
  CHECK(rim.spacing == doctest::Approx(0.05).epsilon(0.2));
  for (const std::uint32_t k : rim.solid) CHECK(rim.background.position[k].z == 0);
  for (const orbit::Vec& p : rim.background.position) CHECK(p.z < 1);
}

TEST_CASE("without a rendered Gaussian of the object a rim is empty") {
  const Rim none = find_rim({}, GaussianCloud{}, {});
  CHECK(none.object.count() == 0);
  CHECK(none.background.count() == 0);
  CHECK(none.spacing == 0);
}

TEST_CASE("the spacing of a square grid is its step; of fewer than two and of coincident points it is 0") {
  std::vector<orbit::Vec> grid;
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i) grid.push_back({0.2 * i, 0.2 * j, 5});
  CHECK(surface_spacing({}, grid) == doctest::Approx(0.2).epsilon(0.15));
  CHECK(surface_spacing({}, {}) == 0);
  CHECK(surface_spacing({}, {{1, 2, 3}}) == 0);
  CHECK(surface_spacing({}, std::vector<orbit::Vec>(9, {1, 2, 3})) == 0);
}

namespace {

/// Points around a hole of radius 0.5, on a dome.
struct Dome {
  std::vector<Vec2<double>> points;
  std::vector<double> heights;

  static double at(double u, double v) { return 1 - 0.3 * (u * u + v * v) + 0.2 * u; }
  Dome() {
    for (int j = -5; j <= 5; ++j)
      for (int i = -5; i <= 5; ++i) {
        const double u = 0.2 * i, v = 0.2 * j;
        if (u * u + v * v > 0.25) {
          points.push_back({u, v});
          heights.push_back(at(u, v));
        }
      }
  }
};

}  // namespace

TEST_CASE("a thin plate passes through its points, and continues a dome into the hole") {
  const Dome dome;
  const ThinPlate plate(dome.points, dome.heights, 0);
  for (std::size_t i = 0; i < dome.points.size(); ++i)
    CHECK(plate.at(dome.points[i].x, dome.points[i].y) == doctest::Approx(dome.heights[i]).epsilon(1e-8));
  CHECK(std::abs(plate.at(0, 0) - Dome::at(0, 0)) < 0.02);  // the mean of the rim is 0.15 lower
  CHECK(std::abs(plate.at(0.2, -0.1) - Dome::at(0.2, -0.1)) < 0.02);
}

TEST_CASE("a thin plate through points of a plane is that plane, far outside of them too") {
  std::vector<double> heights;
  const Dome dome;
  for (const Vec2<double>& p : dome.points) heights.push_back(3 + 2 * p.x - p.y);
  const ThinPlate plate(dome.points, heights, 1e-3);
  CHECK(plate.at(10, -20) == doctest::Approx(43).epsilon(1e-6));
}

TEST_CASE("a thin plate of fewer than three points, coincident points or points on a line is empty and 0") {
  CHECK(ThinPlate().at(1, 2) == 0);
  CHECK(ThinPlate({}, {}, 0).empty());
  CHECK(ThinPlate({{0, 0}, {1, 0}}, {1, 2}, 0).empty());
  CHECK(ThinPlate({{1, 1}, {1, 1}, {1, 1}}, {1, 2, 3}, 0).empty());
  CHECK(ThinPlate({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, {1, 2, 0, 5}, 0).empty());
  CHECK_FALSE(ThinPlate({{0, 0}, {1, 0}, {0, 1}}, {1, 2, 3}, 0).empty());
}

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
    for (int i = 0; i < count; ++i) {
      line.add({-0.4 + 0.02 * i, 0.32, 0}, 2, 0, false);
      place.add({0, 0.35, 0}, 2, 0, false);
    }
    line.add_block({-0.3, -0.3, 0}, {0.3, 0.3, 0.6});
    place.add_block({-0.3, -0.3, 0}, {0.3, 0.3, 0.6});
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

namespace {

using Colour = std::function<double(std::int64_t, std::int64_t)>;

/// A texture of 48 x 40 texels with an unknown square of 13 x 13 in its middle.
TextureGrid with_hole(const Colour& colour) {
  TextureGrid grid{48, 40, {}, {}};
  for (std::int64_t y = 0; y < grid.rows; ++y)
    for (std::int64_t x = 0; x < grid.columns; ++x) {
      const bool unknown = std::abs(x - 24) <= 6 && std::abs(y - 20) <= 6;
      grid.state.push_back(unknown ? Texel::kUnknown : Texel::kKnown);
      for (int c = 0; c < 3; ++c) grid.colour.push_back(unknown ? 77.f : float(colour(x, y)));
    }
  return grid;
}

/// RMS error in the square.
double error_of(const TextureGrid& grid, const Colour& colour) {
  double sum = 0, count = 0;
  for (std::int64_t y = 14; y <= 26; ++y)
    for (std::int64_t x = 18; x <= 30; ++x) {
      const double d = double(grid.colour[std::size_t(3 * (y * grid.columns + x))]) - colour(x, y);
      sum += d * d;
      ++count;
    }
  return std::sqrt(sum / count);
}

double noise(std::int64_t x, std::int64_t y) { return rng_uniform(1, RngStream::kFill, std::uint64_t(64 * y + x)); }

double stripes(std::int64_t x, std::int64_t y) { return ((x + 2 * y) / 5) % 2 == 0 ? 1 : -1; }

}  // namespace

TEST_CASE("oblique stripes and uneven tiles continue through a hole, far better than the blend of the rim") {
  const Colour tiles = [](std::int64_t x, std::int64_t y) { return double((x / 7 + y / 7) % 2) + 0.2 * noise(x, y); };
  for (const Colour& colour : {Colour(stripes), tiles}) {
    TextureGrid repeats = with_hole(colour), blend = repeats;
    CHECK(fill_texture({}, repeats, 0.07) == TextureFill::kPatches);
    fill_smoothly(blend);
    CHECK(error_of(repeats, colour) < 0.25 * error_of(blend, colour));
    for (const Texel state : repeats.state) REQUIRE(state == Texel::kKnown);
  }
}

TEST_CASE("a texture that does not repeat is filled with patches, as rich in contrast as itself") {
  TextureGrid grid = with_hole(noise);
  CHECK(fill_texture({}, grid, 0.07) == TextureFill::kPatches);
  CHECK(error_of(grid, [](std::int64_t, std::int64_t) { return 0.5; }) > 0.2);  // 0.29: the deviation of the noise
}

TEST_CASE("a texture without detail is blended, and a gradient continues exactly") {
  const Colour ramp = [](std::int64_t x, std::int64_t y) { return 0.01 * double(x) - 0.02 * double(y); };
  TextureGrid grid = with_hole(ramp);
  CHECK(fill_texture({}, grid, 0.07) == TextureFill::kSmooth);
  CHECK(error_of(grid, ramp) < 1e-3);
}

TEST_CASE("a texture without known or without unknown texels stays as it is") {
  TextureGrid known = with_hole(stripes), unknown = known, none;
  known.state.assign(known.state.size(), Texel::kKnown);
  unknown.state.assign(unknown.state.size(), Texel::kUnknown);
  CHECK(fill_texture({}, known, 0) == TextureFill::kNothing);
  CHECK(fill_texture({}, unknown, 0) == TextureFill::kNothing);
  CHECK(unknown.state[0] == Texel::kUnknown);
  CHECK(fill_texture({}, none, 0) == TextureFill::kNothing);
}

TEST_CASE("a rim narrower than a patch is blended, and texels that are no part of the texture are not read") {
  TextureGrid grid{6, 6, std::vector<Texel>(36, Texel::kKnown), std::vector<float>(108, 0.5f)};
  grid.state[14] = Texel::kUnknown;
  grid.state[15] = Texel::kNone;
  for (std::size_t c = 0; c < 3; ++c) {
    grid.colour[45 + c] = NAN;
    grid.colour[42 + c] = 9;
  }
  for (std::size_t i = 0; i < 36; ++i) grid.colour[3 * i] += float(0.05 * noise(std::int64_t(i), 0));  // some detail
  CHECK(fill_texture({}, grid, 0.001) == TextureFill::kSmooth);
  CHECK(grid.colour[42] == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("patches have the same bytes for any number of threads") {
  for (const Colour& colour : {Colour(stripes), Colour(noise)}) {
    TextureGrid one = with_hole(colour), three = one;
    Exec exec;
    fill_texture(exec, one, 0.07);
    exec.threads = 3;
    fill_texture(exec, three, 0.07);
    CHECK(one.colour == three.colour);
  }
}

}  // namespace ngs
