#include "ngs/ops/splat/prepared/curve_blocks.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "ngs/math/curve_order.h"

namespace ngs {

TEST_CASE("parallel_curve_order equals curve_order row for row, for any number of threads") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const std::size_t n : {0, 1, 255, 3000, 200000}) {
    CAPTURE(n);
    std::mt19937 random(unsigned(n + 1));
    std::uniform_real_distribution<float> uniform;
    std::vector<float> points;
    for (std::size_t i = 0; i < n; ++i) {
      // A cluster, distant outliers, coincident points and NaNs.
      const float reach = i % 7 == 0 ? 1000.f : i % 5 == 0 ? 0.f : 1.f;
      for (int a = 0; a < 3; ++a) points.push_back(i % 11 == 3 ? kNan : reach * uniform(random));
    }
    const std::vector<std::uint32_t> want = curve_order(points);
    for (const int threads : {1, 3}) {
      const RawColumn<std::uint32_t> got = parallel_curve_order({.threads = threads}, points);
      REQUIRE(got.size() == want.size());
      CHECK(std::equal(got.begin(), got.end(), want.begin()));
    }
  }
}

}  // namespace ngs
