#include "ngs/scene/camera.h"

#include <doctest/doctest.h>

#include <limits>

namespace ngs {

TEST_CASE("project gives the pixel and the depth of a world point, and none behind the camera or outside the image") {
  // 100 x 50 px at (1, 0, 0), looking along the world's x axis: right is -y, down is -z.
  const Camera camera{"", 100, 50, 40, 80, 50, 25, {{0, -1, 0, 0, 0, -1, 1, 0, 0}}, {0, 0, -1}};
  const std::optional<Vec3<double>> seen = camera.project({3, -1, 0.5});
  REQUIRE(seen);
  CHECK(seen->x == 70);
  CHECK(seen->y == 5);
  CHECK(seen->z == 2);
  CHECK(camera.project({3, 2.5, 0}));         // x = 0: the left border belongs to the image
  CHECK_FALSE(camera.project({3, -2.5, 0}));  // x = 100
  CHECK_FALSE(camera.project({1, 0, 0}));     // in the camera's plane
  CHECK_FALSE(camera.project({0, 0, 0}));
  CHECK_FALSE(camera.project({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
}

}  // namespace ngs
