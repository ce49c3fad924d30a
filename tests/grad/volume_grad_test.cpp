// Mutants this kills: T_k for T_{k+1}, a suffix sum that includes the sample itself, a forgotten background.
#include <doctest/doctest.h>

#include "ngs/ops/field/volume_kernels.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

struct VolumeCase {
  std::int64_t rays;
  int samples;
  std::vector<double> density, rgb, spacing;

  VolumeCase(test::Random& random, std::int64_t r, int k)
      : rays(r),
        samples(k),
        density(random.uniform_vector(std::size_t(r * k), 0, 4)),
        rgb(random.uniform_vector(std::size_t(r * k) * 3, 0, 1)),
        spacing(random.uniform_vector(std::size_t(r), 0.1, 1)) {}

  template <class T>
  struct Run {
    std::vector<T> colour, alpha, depth, weight, after;
  };
  template <class T>
  Run<T> forward(const std::vector<T>& d, const std::vector<T>& c) const {
    const auto n = std::size_t(rays);
    const auto s = test::constant<T>(spacing);
    Run<T> o{std::vector<T>(n * 3), std::vector<T>(n), std::vector<T>(n), std::vector<T>(d.size()),
             std::vector<T>(d.size())};
    const VolumeForward<T> kernel{{rays, samples, d.data(), c.data(), s.data(), {T(0.2), T(0.7), T(0.4)}},
                                  o.colour.data(),
                                  o.alpha.data(),
                                  o.depth.data(),
                                  o.weight.data(),
                                  o.after.data()};
    for (std::int64_t r = 0; r < rays; ++r) kernel(r);
    return o;
  }
  struct Grads {
    std::vector<double> density, rgb;
  };
  Grads backward(const std::vector<double>& uc, const std::vector<double>& ua, const std::vector<double>& ud) const {
    const Run<double> o = forward(density, rgb);
    Grads g{std::vector<double>(density.size()), std::vector<double>(rgb.size())};
    const VolumeBackward<double> kernel{{rays, samples, density.data(), rgb.data(), spacing.data(), {0.2, 0.7, 0.4}},
                                        o.weight.data(),
                                        o.after.data(),
                                        uc.data(),
                                        ua.data(),
                                        ud.data(),
                                        g.density.data(),
                                        g.rgb.data()};
    for (std::int64_t r = 0; r < rays; ++r) kernel(r);
    return g;
  }
};

}  // namespace

TEST_CASE("volume: backward equals the adjoint of forward, also behind opaque samples") {
  test::Random random(41);
  for (const auto& size : {std::pair{1, 1}, {1, 2}, {7, 8}, {40, 33}})
    for (const double opaque : {0.0, 1e4}) {  // τ = 1e3 and more: all samples behind have weight exactly 0
      const int rays = size.first, samples = size.second;
      CAPTURE(samples);
      VolumeCase c(random, rays, samples);
      if (opaque > 0) c.density[std::size_t(samples / 2)] = opaque;
      const auto n = std::size_t(rays);
      const auto uc = random.uniform_vector(n * 3, -1, 1), ua = random.uniform_vector(n, -1, 1),
                 ud = random.uniform_vector(n, -1, 1);
      const auto vd = random.uniform_vector(c.density.size(), -1, 1), vc = random.uniform_vector(c.rgb.size(), -1, 1);
      const auto dual = c.forward(test::seed(c.density, vd), test::seed(c.rgb, vc));
      const double u_jv = test::dot(uc, test::deriv(dual.colour)) + test::dot(ua, test::deriv(dual.alpha)) +
                          test::dot(ud, test::deriv(dual.depth));
      const auto g = c.backward(uc, ua, ud);
      CHECK(test::adjoint_difference(u_jv, test::dot(g.density, vd) + test::dot(g.rgb, vc)) < 1e-11);
    }
}

TEST_CASE("volume: the density gradient agrees with extrapolated finite differences") {
  test::Random random(42);
  const VolumeCase c(random, 3, 6);
  const auto uc = random.uniform_vector(9, -1, 1), ua = random.uniform_vector(3, -1, 1),
             ud = random.uniform_vector(3, -1, 1);
  const auto v = random.uniform_vector(18, -1, 1);
  const auto along = [&](double t) {
    const auto o = c.forward(test::moved(c.density, v, t), c.rgb);
    return test::dot(uc, o.colour) + test::dot(ua, o.alpha) + test::dot(ud, o.depth);
  };
  CHECK(test::ridders_difference(test::ridders(along, 0.05), test::dot(c.backward(uc, ua, ud).density, v)) < 1e-9);
}

}  // namespace ngs
