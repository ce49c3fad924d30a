#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/edit/fill/hole_cells.h"
#include "ngs/edit/fill/hole_seeds.h"
#include "ngs/edit/fill/occluder.h"
#include "ngs/math/sh.h"
#include "support/hole_scene.h"

namespace ngs {

TEST_CASE("an occluder hides what is behind the object, and nothing outside its silhouette or in front of it") {
  const test::HoleModel model = test::HoleModel::on_floor();
  const Occluder occluder(find_rim({}, model.cloud, model.object));
  CHECK(occluder.hides({0, 0, 0}, {0, 0, 1}));
  CHECK(occluder.hides({-0.8, 0, 0.3}, {1, 0, 0}));
  CHECK_FALSE(occluder.hides({-0.8, 0, 0.3}, {-1, 0, 0}));
  CHECK_FALSE(occluder.hides({0.5, 0, 0}, {0, 0, 1}));
  CHECK_FALSE(occluder.hides({-0.8, 0.5, 0.3}, {1, 0, 0}));
  CHECK(occluder.contains({0.3, 0, 0.3}));
  CHECK_FALSE(occluder.contains({0, 0, 0.3}));  // hollow
}

TEST_CASE("without an object, and with one at a single point, nothing is hidden") {
  CHECK_FALSE(Occluder(Rim{}).hides({0, 0, 0}, {0, 0, 1}));
  test::HoleModel model;
  model.add({0, 0, 1}, -1, 0, true);
  CHECK_FALSE(Occluder(find_rim({}, model.cloud, model.object)).hides({0, 0, 0}, {0, 0, 1}));
}

namespace {

struct Found {
  Rim rim;
  std::vector<FillSurface> surfaces;
  HoleCells cells;
};

/// The hole in the floor of a model; `slope_rad` above 0: with a further surface, which slopes over the object's place.
Found hole_of(const test::HoleModel& model, double slope_rad = 0) {
  Found found{find_rim({}, model.cloud, model.object), {}, {}};
  found.surfaces = find_fill_surfaces({}, model.cloud, found.rim, FillKind::kPlane, 0);
  REQUIRE_FALSE(found.surfaces.empty());
  if (slope_rad > 0) {
    FillSurface slope = found.surfaces[0];
    const double c = std::cos(slope_rad), s = std::sin(slope_rad);
    slope.u = {c, 0, s};
    slope.v = {0, 1, 0};
    slope.normal = {-s, 0, c};
    slope.origin = {0, 0, 0.5};
    found.surfaces.push_back(slope);
  }
  const std::size_t floor = found.surfaces[0].normal.z > 0.9 ? 0 : 1;
  const Occluder occluder(found.rim);
  const std::vector<std::uint8_t> debris(found.rim.background.count());
  found.cells = find_hole_cells({}, {model.cloud, model.object, found.rim, occluder, found.surfaces, debris}, floor);
  return found;
}

HoleCell state_at(const Found& found, std::size_t surface, orbit::Vec p) {
  const std::int64_t cell = found.cells.cell_of(found.surfaces[surface].coordinates(p));
  REQUIRE(cell >= 0);
  return found.cells.state[std::size_t(cell)];
}

}  // namespace

TEST_CASE("the hole is below the object, and covered cells around it have the floor's colour") {
  const test::HoleModel model = test::HoleModel::on_floor();
  const Found found = hole_of(model);
  CHECK(state_at(found, 0, {0, 0, 0}) == HoleCell::kHole);
  CHECK(state_at(found, 0, {0.24, -0.24, 0}) == HoleCell::kHole);
  CHECK(state_at(found, 0, {0.5, 0.1, 0}) == HoleCell::kCovered);
  CHECK(found.cells.one_sided == 0);
  for (std::size_t i = 0; i < found.cells.state.size(); ++i)
    if (found.cells.state[i] == HoleCell::kCovered) REQUIRE(std::abs(found.cells.colour[3 * i]) < 1e-5f);
  for (std::size_t i = 0; i < std::size_t(model.cloud.size()); ++i) {
    const double far = std::max(std::abs(model.cloud.position[3 * i]), std::abs(model.cloud.position[3 * i + 1]));
    if (!model.object[i] && far > 0.5) REQUIRE(share_in_hole(model.cloud, found.surfaces[0], found.cells, i) < 0.01);
  }
}

TEST_CASE("cells behind another surface are clipped") {
  const test::HoleModel model = test::HoleModel::in_corner();
  const Found found = hole_of(model);
  const std::size_t floor = found.surfaces[0].normal.z > 0.9 ? 0 : 1;
  CHECK(state_at(found, floor, {0, -0.25, 0}) == HoleCell::kHole);
  CHECK(state_at(found, floor, {0, -0.4, 0}) == HoleCell::kClipped);
}

TEST_CASE("remains of the object that slope by 20 degrees clip no floor, a steep surface does") {
  const test::HoleModel model = test::HoleModel::on_floor();
  CHECK(state_at(hole_of(model, 0.35), 0, {0, 0, 0}) == HoleCell::kHole);
  CHECK(state_at(hole_of(model, 0.8), 0, {0, 0, 0}) == HoleCell::kClipped);
}

TEST_CASE("marked cells grow by their margin and stay in the grid") {
  HoleCells cells;
  cells.columns = 5;
  cells.rows = 4;
  std::vector<std::uint8_t> marked(20);
  marked[0] = 1;
  const std::vector<std::uint8_t> by_one = dilated(cells, marked, 1);
  CHECK(std::count(by_one.begin(), by_one.end(), 1) == 4);
  CHECK(by_one[6] == 1);
  CHECK(dilated(cells, marked, 0) == marked);
  CHECK(dilated(cells, marked, 9) == std::vector<std::uint8_t>(20, 1));
}

namespace {

constexpr int kWide_px = 64, kHigh_px = 48;

/// A view that shows the plane n·p = d (camera coordinates) but for a hole.
struct PlaneView {
  Camera camera{"", kWide_px, kHigh_px, 60, 60, 31, 25, {{1, 0, 0, 0, 1, 0, 0, 0, 1}}, {}};
  RenderedView around;
  PixelMask hole = PixelMask(kWide_px * kHigh_px);
  ImageF picture{kWide_px, kHigh_px, 3};
  Vec3<double> normal{0.2, 0.5, 1};
  double distance = 4;

  PlaneView() {
    around.alpha = ImageF(kWide_px, kHigh_px, 1);
    around.depth = around.alpha;
    for (int y = 0; y < kHigh_px; ++y)
      for (int x = 0; x < kWide_px; ++x) {
        const Vec3<double> ray{(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1};
        around.alpha.at(x, y) = 0.9f;
        around.depth.at(x, y) = float(0.9 * distance / dot(normal, ray));
        picture.at(x, y, 1) = 0.75f;
      }
  }
  void open(int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        hole[around.alpha.index(x, y)] = 1;
        around.alpha.at(x, y) = around.depth.at(x, y) = 0;
      }
  }
  GaussianCloud seeds() const {
    GaussianCloud cloud;
    const std::int64_t added = add_hole_seeds({camera, around, hole, picture}, cloud);
    CHECK(added == cloud.size());
    return cloud;
  }
};

}  // namespace

TEST_CASE("seeds of a hole in a plane lie in the plane, one for each cell, in the picture's colour") {
  PlaneView view;
  view.open(16, 12, 48, 36);
  const GaussianCloud cloud = view.seeds();
  REQUIRE(cloud.size() == 8 * 6);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    const Vec3<double> p{double(cloud.position[3 * i]), double(cloud.position[3 * i + 1]),
                         double(cloud.position[3 * i + 2])};
    CAPTURE(i);
    CHECK(dot(view.normal, p) == doctest::Approx(view.distance).epsilon(0.01));
    CHECK(std::exp(double(cloud.log_scale[3 * i])) == doctest::Approx(0.6 * 4 * p.z / 60).epsilon(1e-5));
    CHECK(colour_of_dc(cloud.sh_dc[3 * i + 1]) == doctest::Approx(0.75).epsilon(1e-5));
    CHECK(colour_of_dc(cloud.sh_dc[3 * i]) == doctest::Approx(0).epsilon(1e-5).scale(1));
  }
}

TEST_CASE("covered pixels of a hole, an empty hole and a view that shows nothing get no seed") {
  PlaneView covered;
  covered.hole.assign(covered.hole.size(), 1);
  CHECK(covered.seeds().size() == 0);
  CHECK(PlaneView().seeds().size() == 0);
  PlaneView nothing;
  nothing.open(0, 0, kWide_px, kHigh_px);
  CHECK(nothing.seeds().size() == 0);
}

TEST_CASE("seeds are added behind the rows of a cloud, with its degree") {
  PlaneView view;
  view.open(20, 20, 24, 24);
  GaussianCloud cloud;
  cloud.resize(3, 2);
  cloud.position[0] = 7;
  CHECK(add_hole_seeds({view.camera, view.around, view.hole, view.picture}, cloud) == 1);
  CHECK(cloud.size() == 4);
  CHECK(cloud.position[0] == 7);
  CHECK(cloud.sh_rest.size() == 4 * 3 * 8);
  CHECK(cloud.sh_rest.back() == 0);
}

}  // namespace ngs
