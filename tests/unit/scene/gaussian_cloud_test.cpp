#include "ngs/scene/gaussian_cloud.h"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "ngs/scene/boundary_set.h"

namespace ngs {

GaussianCloud plain_cloud(std::int64_t n) {
  GaussianCloud cloud;
  cloud.resize(n, 1);
  for (std::int64_t i = 0; i < n; ++i) cloud.rotation[std::size_t(i) * 4] = 1;
  return cloud;
}

TEST_CASE("classify keeps finite Gaussians and counts the others by reason") {
  GaussianCloud cloud = plain_cloud(8);
  cloud.position[0] = NAN;
  cloud.logit_opacity[1] = -INFINITY;  // legal: absent
  cloud.logit_opacity[2] = NAN;
  cloud.log_scale[3 * 3 + 1] = -INFINITY;
  cloud.log_scale[4 * 3] = kMaxLogScale + 1;
  cloud.rotation[5 * 4] = 0;  // zero quaternion: identity
  cloud.sh_rest[6 * 9 + 4] = INFINITY;
  const CloudHealth health = classify(cloud);
  CHECK(health.total == 8);
  CHECK(health.non_finite == 3);
  CHECK(health.absurd_scale == 2);
  CHECK(health.zero_rotation == 1);
  CHECK(cloud.usable == std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 0, 1});
}

TEST_CASE("classify accepts an empty cloud") {
  GaussianCloud cloud;
  CHECK(classify(cloud).total == 0);
}

TEST_CASE("the boundary set lists the usable flagged Gaussians in ascending order") {
  GaussianCloud cloud;
  cloud.resize(4, 0);
  for (std::size_t i = 0; i < 12; ++i) {
    cloud.position[i] = float(i);
    cloud.sh_dc[i] = 1;
  }
  cloud.usable[3] = 0;
  const BoundarySet b = boundary_set(cloud, {0.f, 1.f, 1.f, 1.f});
  CHECK(b.row == std::vector<std::uint32_t>{1, 2});
  CHECK(b.position == std::vector<float>{3, 4, 5, 6, 7, 8});
  CHECK(b.colour[0] == doctest::Approx(0.78209479));
  CHECK_THROWS_AS(boundary_set(cloud, {1.f}), std::logic_error);
  CHECK(boundary_set(GaussianCloud{}, {}).size() == 0);
}

}  // namespace ngs
