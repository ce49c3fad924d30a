#include "ngs/math/lanes.h"

#include <doctest/doctest.h>

#include <cmath>

namespace ngs {

TEST_CASE("exp2_where stays within 0.8 ulp of exp2 over [-126, 0]") {
  double worst = 0;
  for (int i = 0; i <= 2000000; ++i) {
    const float x = -126.f * float(i) / 2000000.f;
    const double want = std::exp2(double(x));
    const double ulp = double(std::nextafter(float(want), 2.f)) - double(float(want));
    worst = std::max(worst, std::abs(double(exp2_where(true, x)) - want) / ulp);
  }
  MESSAGE("worst error in ulp: ", worst);
  CHECK(worst < 0.8);
}

TEST_CASE("exp2_where of a pack equals the scalar in every lane") {
  for (int i = 0; i < 100000; ++i) {
    float in[8], out[8];
    for (int k = 0; k < 8; ++k) in[k] = -float(i * 8 + k) * 1.2e-4f;
    PackF x;
    load_lanes(in, x);
    const float bound = in[i % 8];
    store_lanes(out, exp2_where(x <= PackF(bound), x));
    for (int k = 0; k < 8; ++k) REQUIRE(out[k] == exp2_where(in[k] <= bound, in[k]));
  }
}

}  // namespace ngs
