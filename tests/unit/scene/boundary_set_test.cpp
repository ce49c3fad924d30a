#include "ngs/scene/boundary_set.h"

#include <doctest/doctest.h>

#include <stdexcept>

namespace ngs {

TEST_CASE("the boundary set lists the usable flagged Gaussians in ascending order") {
  GaussianCloud cloud;
  cloud.resize(4, 0);
  for (std::size_t i = 0; i < 12; ++i) cloud.position[i] = float(i), cloud.sh_dc[i] = 1;
  cloud.usable[3] = 0;
  const BoundarySet b = boundary_set(cloud, {0.f, 1.f, 1.f, 1.f});
  CHECK(b.row == std::vector<std::uint32_t>{1, 2});
  CHECK(b.position == std::vector<float>{3, 4, 5, 6, 7, 8});
  CHECK(b.colour[0] == doctest::Approx(0.78209479));
  CHECK_THROWS_AS(boundary_set(cloud, {1.f}), std::logic_error);
  CHECK(boundary_set(GaussianCloud{}, {}).size() == 0);
}

}  // namespace ngs
