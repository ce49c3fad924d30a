#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/rng.h"
#include "ngs/math/dual.h"
#include "ngs/ops/losses/photometric_impl.h"
#include "support/adjoint.h"

namespace ngs {
namespace {

using D = Dual<double>;

Image<double> random_image(int w, int h, int c, std::uint64_t seed) {
  Image<double> image(w, h, c);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = rng_uniform(seed, RngStream::kTest, i);
  return image;
}

struct Case {
  int w, h, c;
  PixelRect box;
  bool weighted;
};
const Case kCases[] = {{1, 1, 1, {}, false},
                       {7, 5, 3, {}, false},
                       {19, 16, 3, {}, true},
                       {24, 18, 2, {8, 3, 17, 12}, false},
                       {24, 18, 3, {0, 10, 9, 18}, true}};

}  // namespace

TEST_CASE("photometric: the gradient equals the adjoint of the dual-number forward pass") {
  for (const Case& k : kCases) {
    CAPTURE(k.w);
    const Image<double> x = random_image(k.w, k.h, k.c, 1), y = random_image(k.w, k.h, k.c, 2);
    ImageF weight(k.w, k.h, 1);
    for (std::size_t i = 0; i < weight.data.size(); ++i) weight.data[i] = float(rng_uniform(3, RngStream::kTest, i));
    const ImageF* w = k.weighted ? &weight : nullptr;
    const PhotometricOptions options{.dssim_weight = 0.35, .box = k.box};

    Image<double> gradient;
    const auto value = PhotometricPass<double>().evaluate({}, options, {x, y, w}, &gradient);
    Image<D> dual_x(k.w, k.h, k.c), dual_y(k.w, k.h, k.c);
    double jt_v = 0, scale = 0;
    for (std::size_t i = 0; i < x.data.size(); ++i) {
      const double v = 2 * rng_uniform(4, RngStream::kTest, i) - 1;
      dual_x.data[i] = D(x.data[i], v);
      dual_y.data[i] = D(y.data[i]);
      jt_v += gradient.data[i] * v;
      scale += std::abs(gradient.data[i] * v);
    }
    const auto dual = PhotometricPass<D, D>().evaluate({}, options, {dual_x, dual_y, w}, nullptr);
    CHECK(dual.total.v == doctest::Approx(value.total).epsilon(1e-14));
    CHECK(test::adjoint_difference(dual.total.d, jt_v, scale) < 1e-12);
  }
}

TEST_CASE("photometric: the gradient agrees with extrapolated finite differences") {
  const Image<double> x = random_image(9, 8, 3, 11), y = random_image(9, 8, 3, 12);
  Image<double> gradient;
  PhotometricPass<double> pass;
  pass.evaluate({}, {}, {x, y}, &gradient);
  const auto loss = [&](double t) {
    Image<double> moved = x;
    for (std::size_t i = 0; i < x.data.size(); ++i) moved.data[i] += t * (2 * rng_uniform(5, RngStream::kTest, i) - 1);
    return pass.evaluate({}, {}, {moved, y}, nullptr).total;
  };
  double want = 0;
  for (std::size_t i = 0; i < x.data.size(); ++i)
    want += gradient.data[i] * (2 * rng_uniform(5, RngStream::kTest, i) - 1);
  double nearest_kink = 1;
  for (std::size_t i = 0; i < x.data.size(); ++i)
    nearest_kink = std::min(nearest_kink, std::abs(x.data[i] - y.data[i]));
  REQUIRE(nearest_kink > 3e-4);  // so the largest step changes no sign of x - y
  CHECK(test::ridders_difference(test::ridders(loss, 3e-4), want) < 1e-7);
}

}  // namespace ngs
