#include "ngs/edit/fill/occluder.h"

#include <doctest/doctest.h>

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

}  // namespace ngs
