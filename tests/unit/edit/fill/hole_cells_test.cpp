#include "ngs/edit/fill/hole_cells.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/hole_scene.h"

namespace ngs {
namespace {

struct Found {
  Rim rim;
  std::vector<FillSurface> surfaces;
  HoleCells cells;
};

/// The hole in the floor of a model.
Found hole_of(const test::HoleModel& model) {
  Found found{find_rim({}, model.cloud, model.object), {}, {}};
  found.surfaces = find_fill_surfaces({}, model.cloud, found.rim, FillKind::kPlane, 0);
  REQUIRE_FALSE(found.surfaces.empty());
  const std::size_t floor = found.surfaces[0].normal.z > 0.9 ? 0 : 1;
  const Occluder occluder(found.rim);
  const std::vector<std::uint8_t> debris(found.rim.background.count());
  found.cells = find_hole_cells({}, {model.cloud, found.rim, occluder, found.surfaces, debris}, floor);
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

TEST_CASE("marked cells grow by their margin and stay in the grid") {
  HoleCells cells;
  cells.columns = 5, cells.rows = 4;
  std::vector<std::uint8_t> marked(20);
  marked[0] = 1;
  const std::vector<std::uint8_t> by_one = grown(cells, marked, 1);
  CHECK(std::count(by_one.begin(), by_one.end(), 1) == 4);
  CHECK(by_one[6] == 1);
  CHECK(grown(cells, marked, 0) == marked);
  CHECK(grown(cells, marked, 9) == std::vector<std::uint8_t>(20, 1));
}

}  // namespace ngs
