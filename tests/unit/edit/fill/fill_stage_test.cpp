#include "ngs/edit/fill/fill_stage.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/edit/fill/texture_sources.h"
#include "support/hole_scene.h"

namespace ngs {
namespace {

using test::HoleModel;

HoleFill filled(const HoleModel& model, int threads = 1, FillKind kind = FillKind::kAuto) {
  Monitor monitor;
  return fill_hole({.threads = threads}, monitor, {.fill = kind}, {model.cloud, model.object}, 0);
}

orbit::Vec position(const GaussianCloud& cloud, std::size_t i) {
  return {cloud.position[3 * i], cloud.position[3 * i + 1], cloud.position[3 * i + 2]};
}

}  // namespace

TEST_CASE("the hole below a block is covered by flat Gaussians of the floor's height and colour") {
  const HoleModel model = HoleModel::on_floor();
  const HoleFill fill = filled(model);
  CHECK(fill.nothing.empty());
  REQUIRE(fill.surfaces.size() == 1);
  CHECK(fill.surfaces[0].rows == fill.filled.size());
  const double area = double(fill.filled.size()) * fill.surfaces[0].cell_side * fill.surfaces[0].cell_side;
  CHECK(area == doctest::Approx(0.36).epsilon(0.3));
  for (std::size_t i = 0; i < std::size_t(fill.filled.size()); ++i) {
    const orbit::Vec p = position(fill.filled, i);
    REQUIRE(std::abs(p.z) < 0.01);
    REQUIRE(std::max(std::abs(p.x), std::abs(p.y)) < 0.42);
    REQUIRE(std::abs(fill.filled.sh_dc[3 * i]) < 1e-4);
    REQUIRE(fill.filled.usable[i] == 1);
  }
  CHECK(fill.filled.log_scale[2] < fill.filled.log_scale[0] - 1);
}

TEST_CASE("a thing that lies on the floor next to the hole is no source of its texture") {
  HoleModel model;
  const auto under = [](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 0.28; };
  const auto grey = [](double x, double y) {
    return x > 0.28 && x < 0.8 && std::abs(y) < 0.2 ? 1.5 : 0.2 * std::sin(40 * x);
  };
  model.add_floor([](double, double) { return 0.0; }, grey, under);
  model.add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
  const Rim rim = find_rim({}, model.cloud, model.object);
  const std::vector<FillSurface> surfaces = find_fill_surfaces({}, model.cloud, rim, FillKind::kPlane, 0);
  REQUIRE_FALSE(surfaces.empty());
  const Occluder occluder(rim);
  const std::vector<std::uint8_t> debris(rim.background.count());
  const HoleScene scene{model.cloud, model.object, rim, occluder, surfaces, debris};
  Shadows shadows;
  const HoleCells& cells = shadows.cells = find_hole_cells({}, scene, 0);
  const TextureGrid grid = texture_sources({}, scene, 0, shadows);
  const auto state_at = [&](double x, double y) {
    return grid.state.at(std::size_t(cells.cell_of(surfaces[0].coordinates({x, y, 0}))));
  };
  CHECK(cells.state.at(std::size_t(cells.cell_of(surfaces[0].coordinates({0.5, 0, 0})))) == HoleCell::kCovered);
  CHECK(state_at(0.5, 0) == Texel::kNone);
  CHECK(state_at(-0.5, 0) == Texel::kKnown);
  CHECK(state_at(0, 0) == Texel::kUnknown);
}

TEST_CASE("the floor in the shadow of the removed block is relit, and without a shadow nothing is") {
  HoleModel model, lit;
  model.spacing = lit.spacing = 0.035;
  const auto under = [](double x, double y) { return std::max(std::abs(x), std::abs(y)) < 0.28; };
  const auto in_shadow = [](double x, double y) { return std::abs(y) < 0.34 && x < 0.28 && x > -0.69; };
  const auto check = [](double x, double y) { return (std::sin(15 * x) > 0) == (std::sin(15 * y) > 0) ? 0.8 : 0.2; };
  const auto shaded = [&](double x, double y) {  // 0.4 of the colour
    return in_shadow(x, y) ? (0.4 * (0.5 + 0.2820948 * check(x, y)) - 0.5) / 0.2820948 : check(x, y);
  };
  model.add_floor([](double, double) { return 0.0; }, shaded, under);
  lit.add_floor([](double, double) { return 0.0; }, check, under);
  for (HoleModel* m : {&model, &lit}) m->add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
  const HoleFill fill = filled(model);
  CHECK(fill.surfaces[0].shadow.shadow_factor == doctest::Approx(0.4).epsilon(0.25));
  CHECK(fill.surfaces[0].shadow.light.x == doctest::Approx(0.5).epsilon(0.2));
  REQUIRE(fill.relit_rows > 30);
  const auto relit_from = std::size_t(fill.filled.size() - fill.relit_rows);
  std::int64_t right = 0;
  for (std::size_t i = relit_from; i < std::size_t(fill.filled.size()); ++i) {
    const orbit::Vec p = position(fill.filled, i);
    right += std::abs(double(fill.filled.sh_dc[3 * i]) - check(p.x, p.y)) < 0.35;  // of 1.4 in the shadow
  }
  CHECK(double(right) > 0.6 * double(fill.relit_rows));                                  // others are at the outline
  for (std::size_t i = 0; i < relit_from; ++i) REQUIRE(fill.filled.sh_dc[3 * i] > 0.f);  // no copies of the shadow
  CHECK(filled(model, 3).filled.sh_dc == fill.filled.sh_dc);
  CHECK(filled(lit).relit_rows == 0);
}

TEST_CASE("the dark ring around the removed block is relit, and the fill has the floor's colour, not the ring's") {
  HoleModel model;
  const auto from_middle = [](double x, double y) { return std::max(std::abs(x), std::abs(y)); };
  const auto check = [](double x, double y) { return (std::sin(15 * x) > 0) == (std::sin(15 * y) > 0) ? 0.8 : 0.2; };
  model.add_floor([](double, double) { return 0.0; },
                  [&](double x, double y) {  // half of the colour
                    return from_middle(x, y) < 0.39 ? 0.5 * check(x, y) - 0.25 / 0.2820948 : check(x, y);
                  },
                  [&](double x, double y) { return from_middle(x, y) < 0.28; });
  model.add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
  const HoleFill fill = filled(model);
  REQUIRE(fill.relit_rows > 15);
  double wrong = 0;
  for (std::size_t i = 0; i < std::size_t(fill.filled.size()); ++i) {
    const orbit::Vec p = position(fill.filled, i);
    wrong += std::abs(double(fill.filled.sh_dc[3 * i]) - check(p.x, p.y)) > 0.35;  // the ring: 0.5 to 0.8 darker
  }
  CHECK(wrong < 0.2 * double(fill.filled.size()));
  CHECK(filled(model, 3).filled.sh_dc == fill.filled.sh_dc);
}

TEST_CASE("a large faint plume before the filled floor is removed with the object") {
  HoleModel model = HoleModel::on_floor();
  model.add({0.05, 0, 0.5}, -1, -1, false);
  const std::size_t plume = model.object.size() - 1;
  for (std::size_t a = 0; a < 3; ++a) model.cloud.log_scale[3 * plume + a] = std::log(0.15f);
  model.cloud.logit_opacity[plume] = -1.9f;  // 0.13
  CHECK(filled(model).removed[plume] == 1);
  model.cloud.logit_opacity[plume] = 3;  // a solid ball of this size is no smear
  CHECK(filled(model).removed[plume] == 0);
}

TEST_CASE("the cells below the object are counted as filled, covered and open") {
  const Footprint footprint = filled(HoleModel::on_floor()).surfaces.at(0).footprint;
  CHECK(footprint.cells > 50);
  CHECK(double(footprint.filled) > 0.95 * double(footprint.cells));
  CHECK(footprint.filled + footprint.covered == footprint.cells);
}

TEST_CASE("in a corner both holes are filled, and joined at the line where the planes meet") {
  const HoleModel model = HoleModel::in_corner();
  const HoleFill fill = filled(model);
  REQUIRE(fill.surfaces.size() == 2);
  int floor = 0, wall = 0;
  double nearest_floor = 1, nearest_wall = 1;
  for (std::size_t i = 0; i < std::size_t(fill.filled.size()); ++i) {
    const orbit::Vec p = position(fill.filled, i);
    REQUIRE(p.z > -0.02);        // neither below the floor
    REQUIRE(p.y > -0.3 - 0.02);  // nor behind the wall
    const bool is_wall = fill.filled.sh_dc[3 * i] < -0.5f;
    (is_wall ? wall : floor) += 1;
    double& nearest = is_wall ? nearest_wall : nearest_floor;
    nearest = std::min(nearest, is_wall ? p.z : p.y + 0.3);
    REQUIRE(std::abs(is_wall ? p.y + 0.3 : p.z) < 0.01);
  }
  CHECK(floor > 50);
  CHECK(wall > 50);
  CHECK(nearest_floor < 0.05);
  CHECK(nearest_wall < 0.05);
}

TEST_CASE("an object without visible Gaussians, without ground, and over a whole floor has no hole to fill") {
  HoleModel none;
  none.add_floor([](double, double) { return 0.0; }, [](double, double) { return 0.0; },
                 [](double, double) { return false; });
  CHECK(filled(none).nothing == "the object has no visible Gaussian");
  HoleModel floating;
  floating.add_block({-0.3, -0.3, 0}, {0.3, 0.3, 0.6});
  CHECK(filled(floating).nothing == "the background has no surface at the object's rim");
  HoleModel whole = none;
  whole.add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
  const HoleFill fill = filled(whole);
  CHECK(fill.nothing == "the background continues below the object");
  CHECK(fill.filled.size() == 0);
  CHECK(fill.removed_rows == 0);
  CHECK(filled(HoleModel{}).nothing == "the object has no visible Gaussian");
}

TEST_CASE("a dense floor that lacks a tenth below the object continues, one that lacks a third is filled") {
  const auto lacks = [](double half, int layers) {
    HoleModel model;
    const auto zero = [](double, double) { return 0.0; };
    const auto from_middle = [](double x, double y) { return std::max(std::abs(x), std::abs(y)); };
    const auto is_hole = [&](double x, double y) { return from_middle(x, y) < half; };
    model.add_floor(zero, zero, is_hole);
    for (int k = 1; k < layers; ++k)
      model.add_floor(zero, zero, [&](double x, double y) { return is_hole(x, y) || from_middle(x, y) > 0.4; });
    model.add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
    return filled(model);
  };
  CHECK(lacks(0.11, 2).nothing == "the background continues below the object");
  CHECK(lacks(0.24, 2).filled.size() > 50);
  CHECK(lacks(0.11, 4).filled.size() > 50);  // what is left of the object
}

TEST_CASE("a rim on one side of the object only is not continued") {
  HoleModel model;
  model.add_floor([](double, double) { return 0.0; }, [](double, double) { return 0.0; },
                  [](double x, double) { return x > -0.25; });
  model.add_block({-0.3, -0.3, 0.03}, {0.3, 0.3, 0.6});
  const HoleFill fill = filled(model);
  CHECK(fill.filled.size() == 0);
  CHECK(fill.nothing.find("missing on one side") != std::string::npos);
}

TEST_CASE("half-transparent Gaussians around the object are removed, those of the floor and far ones stay") {
  HoleModel model = HoleModel::on_floor();
  const std::size_t first = model.object.size();
  model.add({0.32, 0, 0.3}, -1, 1, false);
  model.add({0, 0, 0.3}, -1, 1, false);
  model.add({0.8, 0.8, 0.3}, -1, 1, false);
  model.add({0.5, 0, 0}, 2, 1, false);
  for (std::size_t i = first; i < model.object.size(); ++i) model.cloud.logit_opacity[i] = -1;
  const HoleFill fill = filled(model);
  CHECK(fill.removed[first] == 1);
  CHECK(fill.removed[first + 1] == 1);
  CHECK(fill.removed[first + 2] == 0);
  CHECK(fill.removed[first + 3] == 0);
  CHECK(fill.removed_rows == std::count(fill.removed.begin(), fill.removed.end(), 1));
  for (std::size_t i = 0; i < model.object.size(); ++i)
    if (model.object[i]) REQUIRE(fill.removed[i] == 0);
}

TEST_CASE("an opaque needle at the object is a rod of something else and stays, a crumb goes") {
  HoleModel model = HoleModel::on_floor();
  model.add({0.35, 0, 0.3}, -1, -1, false);
  const std::size_t i = model.object.size() - 1;
  CHECK(filled(model).removed[i] == 1);
  model.cloud.log_scale[3 * i] = model.cloud.log_scale[3 * i + 1] = std::log(0.01f);
  model.cloud.log_scale[3 * i + 2] = std::log(0.07f);
  CHECK(filled(model).removed[i] == 0);
}

TEST_CASE("a fill has the same bytes for any number of threads") {
  const HoleModel model = HoleModel::in_corner();
  const HoleFill one = filled(model), three = filled(model, 3);
  CHECK(one.filled.position == three.filled.position);
  CHECK(one.filled.sh_dc == three.filled.sh_dc);
  CHECK(one.removed == three.removed);
}

TEST_CASE("unusable Gaussians at the rim change nothing") {
  HoleModel model = HoleModel::on_floor();
  const HoleFill before = filled(model);
  model.add({NAN, 0, 0}, 2, 0, false);
  model.cloud.usable.back() = 0;
  model.add({0.1, 0, 0}, 2, NAN, true);
  model.cloud.usable.back() = 0;
  CHECK(filled(model).filled.position == before.filled.position);
}

}  // namespace ngs
