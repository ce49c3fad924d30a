#include "ngs/edit/fill/rim.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

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

}  // namespace ngs
