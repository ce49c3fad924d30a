// Volume rendering: thin, opaque, empty and overflowing rays.                                          Eq. (1)
#include <doctest/doctest.h>

#include "ngs/ops/field/volume_kernels.h"
#include "ngs/ops/losses/loss_mask.h"
#include "support/stability.h"

namespace ngs {
namespace {

using test::Random;
using test::Worst;
using Real = long double;

/// One ray of K samples, rendered by ngs and by a reference in long double.
struct Ray {
  int samples;
  std::vector<float> density, rgb, weight, after, grad_density, grad_rgb;
  float spacing = 1, colour[3] = {}, alpha = 0, depth = 0;
  Vec3<float> background{0.2f, 0.7f, 0.4f};

  Ray(Random& random, int k, double tau)
      : samples(k),
        density(random.uniform_vector<float>(std::size_t(k), 0.2 * tau, tau)),
        rgb(random.uniform_vector<float>(std::size_t(k) * 3, 0.1, 1)) {}

  VolumeRays<float> rays() const { return {1, samples, density.data(), rgb.data(), &spacing, background}; }
  void forward() {
    weight.resize(density.size());
    after.resize(density.size());
    VolumeForward<float>{rays(), colour, &alpha, &depth, weight.data(), after.data()}(0);
  }
  void backward(const float* grad_colour, float grad_alpha) {
    grad_density.resize(density.size());
    grad_rgb.resize(rgb.size());
    VolumeBackward<float>{rays(),      weight.data(), after.data(),        grad_colour,
                          &grad_alpha, nullptr,       grad_density.data(), grad_rgb.data()}(0);
  }
  /// ∂(g · C)/∂(density k) by the textbook form ∂C/∂α_k = T_k c_k - behind / (1 - α_k).
  float printed_gradient(int k, const float* g) const {
    const auto along = [&](int m) {
      const float* c = &rgb[std::size_t(m) * 3];
      return g[0] * c[0] + g[1] * c[1] + g[2] * c[2];
    };
    float behind = after.back() * (g[0] * background.x + g[1] * background.y + g[2] * background.z);
    for (int m = samples; --m > k;) behind += weight[std::size_t(m)] * along(m);
    const float through = 1 - (1 - std::exp(-density[std::size_t(k)] * spacing)),
                before = k > 0 ? after[std::size_t(k - 1)] : 1.f;
    return spacing * through * (before * along(k) - behind / through);
  }
  Real tau(int k) const { return Real(density[std::size_t(k)]) * spacing; }
  Real depth_before(int k) const {
    Real sum = 0;
    for (int m = 0; m < k; ++m) sum += tau(m);
    return sum;
  }
  Real want_weight(int k) const { return std::exp(-depth_before(k)) * -std::expm1(-tau(k)); }
  float end() const { return spacing * after.back(); }  // contribution of grad_alpha to the gradient of every density
  bool finite() const {
    bool fine = std::isfinite(alpha);
    for (const auto* values : {&weight, &after, &grad_density, &grad_rgb})
      for (const float x : *values) fine &= std::isfinite(x);
    for (const float c : colour) fine &= std::isfinite(c);
    return fine;
  }
};

}  // namespace

HARD_CASE("volume: thin samples keep the relative accuracy of their weights", "tau", {1, 1e-3, 1e-6, 1e-12}, 0.98,
          {"T_k - T_k+1", 2e6}) {
  Ray ray(random, 8, h);
  ray.forward();
  float through = 1;
  for (int k = 0; k < 8; ++k) {
    const auto at = std::size_t(k);
    worst.ours(ray.weight[at], ray.want_weight(k), 2 + 8 * ray.depth_before(k));
    const float next = through * std::exp(-ray.density[at] * ray.spacing);
    worst.naive(through - next, ray.want_weight(k), 2 + 8 * ray.depth_before(k));
    through = next;
  }
}

HARD_CASE("volume: alpha keeps its relative accuracy on thin rays", "tau", {1, 1e-3, 1e-6, 1e-12}, 0.77,
          {"1 - Π (1 - α_k)", 1e6}) {
  Ray ray(random, 8, h);
  ray.forward();
  float through = 1;
  for (int k = 0; k < 8; ++k) through *= 1 - (1 - std::exp(-ray.density[std::size_t(k)] * ray.spacing));
  const Real want = -std::expm1(-ray.depth_before(8));
  worst.ours(ray.alpha, want, 4);
  worst.naive(1 - through, want, 4);
}

HARD_CASE("volume: transmittance keeps its relative accuracy at large optical depth", "tau", {0.1, 1, 5, 10}, 0.63,
          {"Π (1 - α_k), α_k in float", 60}) {
  Ray ray(random, 8, h);
  ray.forward();
  float through = 1;
  for (int k = 0; k < 8; ++k) {
    through *= 1 - (1 - std::exp(-ray.density[std::size_t(k)] * ray.spacing));
    const Real want = std::exp(-ray.depth_before(k + 1)), condition = 1 + 4 * ray.depth_before(k + 1);
    worst.ours(ray.after[std::size_t(k)], want, condition);
    worst.naive(through, want, condition);
  }
}

HARD_CASE("volume: a ray of one colour over the same background has that colour", "tau", {1e-6, 1, 1e2, 1e4}, 5,
          "not applicable: as printed the weights add up to 1 as well") {
  Ray ray(random, 16, h);
  for (std::size_t i = 0; i < ray.rgb.size(); ++i) ray.rgb[i] = (&ray.background.x)[i % 3];
  ray.forward();
  for (int c = 0; c < 3; ++c) worst.ours(ray.colour[c], (&ray.background.x)[c]);
}

HARD_CASE("volume: opaque and overflowing densities give finite colours, alphas and gradients", "density",
          {1, 1e4, 1e30, 3e38}, 0, {"T_k c_k - behind / (1 - α_k)", test::kWrong}) {
  Ray ray(random, 8, h);
  ray.spacing = h > 1e37 ? 1e10f : 1.f;
  ray.forward();
  const float g[3] = {1, -1, 0.5f};
  ray.backward(g, 1);
  worst.ours_is(ray.finite() && ray.alpha <= 1 && ray.alpha > 0);
  worst.naive_is(std::isfinite(ray.printed_gradient(3, g)));
}

HARD_CASE("volume: samples behind an opaque one have no weight and no gradient", "density", {1, 200, 1e4, 1e30}, 0,
          {"T_k c_k - behind / (1 - α_k)", test::kWrong}) {
  Ray ray(random, 8, 1);
  ray.density[2] = float(h);
  ray.forward();
  const float g[3] = {1, -1, 0.5f};
  ray.backward(g, 1);
  bool silent = ray.alpha == 1;
  for (std::size_t k = 3; k < 8; ++k) silent &= ray.grad_density[k] == 0 && ray.weight[k] == 0;
  worst.ours_is(ray.finite() && silent == (h > 100));
  for (int k = 2; k < 8; ++k)  // the sample itself too
    worst.naive_is(std::abs(ray.printed_gradient(k, g) - (ray.grad_density[std::size_t(k)] - ray.end())) < 1e-4f);
}

HARD_CASE("volume: without spacing a ray is empty and its gradients are exactly zero", "spacing, world",
          {1e-3, 1e-20, 0}, 0.88, {"T_k as w_k / α_k", test::kWrong}) {
  Ray ray(random, 8, 3);
  ray.spacing = float(h);
  ray.forward();
  const float g[3] = {1, -1, 0.5f};
  ray.backward(g, 1);
  worst.ours_is(ray.finite());
  if (h > 0) worst.ours(ray.alpha, -std::expm1(-ray.depth_before(8)), 4);
  if (h == 0)
    for (std::size_t k = 0; k < 8; ++k) worst.ours_is(ray.grad_density[k] == 0 && ray.weight[k] == 0);
  worst.naive(ray.weight[0] / (1 - std::exp(-ray.density[0] * ray.spacing)), 1);
}

HARD_CASE("volume: empty space is exactly empty and still has a gradient", "density", {0}, 0.78,
          "not applicable: every form agrees where tau is exactly 0") {
  Ray ray(random, 8, 0);
  ray.forward();
  const float g[3] = {1, 2, 3};
  ray.backward(g, 0);
  worst.ours_is(ray.alpha == 0 && ray.depth == 0 && ray.colour[1] == ray.background.y);
  for (int k = 0; k < 8; ++k) {
    Real along = 0, size = 0;  // ∂C/∂τ_k = c_k - background
    for (int c = 0; c < 3; ++c) {
      const Real term = Real(g[c]) * (Real(ray.rgb[std::size_t(k * 3 + c)]) - (&ray.background.x)[c]);
      along += term;
      size += std::abs(Real(g[c])) * 2;
    }
    worst.ours(ray.grad_density[std::size_t(k)], along, size / std::abs(along));
  }
}

HARD_CASE("volume: a ray without samples is the background", "samples", {0}, 0, "not applicable: no formula is left") {
  Ray ray(random, 0, 1);
  ray.forward();
  worst.ours_is(ray.alpha == 0 && ray.depth == 0 && ray.colour[0] == ray.background.x &&
                ray.colour[2] == ray.background.z);
}

HARD_CASE("volume: the density gradient keeps its accuracy where the rest of the ray is faint", "tau", {0.1, 2, 6, 20},
          0.71, {"total - prefix for what lies behind", 3e4}) {
  Ray ray(random, 12, h);
  ray.background = {0, 0, 0};
  ray.forward();
  const float g[3] = {1, 0.5f, 0.25f};
  ray.backward(g, 0);
  float total = 0, prefix = 0;
  std::vector<float> along(12);
  for (std::size_t k = 0; k < 12; ++k) {
    along[k] = ray.rgb[k * 3] + 0.5f * ray.rgb[k * 3 + 1] + 0.25f * ray.rgb[k * 3 + 2];
    total += ray.weight[k] * along[k];
  }
  for (int k = 0; k < 12; ++k) {
    const auto at = std::size_t(k);
    Real behind = 0, own = 0;
    for (int m = k + 1; m < 12; ++m)
      for (int c = 0; c < 3; ++c) behind += ray.want_weight(m) * g[c] * ray.rgb[std::size_t(m * 3 + c)];
    for (int c = 0; c < 3; ++c) own += std::exp(-ray.depth_before(k + 1)) * g[c] * ray.rgb[std::size_t(k * 3 + c)];
    const Real want = own - behind, condition = (own + behind) * (4 + 4 * ray.depth_before(12)) / std::abs(want);
    if (ray.depth_before(12) > 80) continue;
    worst.ours(ray.grad_density[at], want, condition);
    prefix += ray.weight[at] * along[at];
    worst.naive(ray.after[at] * along[at] - (total - prefix), want, condition);
  }
}

HARD_CASE("volume: the density weight of the mask loss is defined for any optical depth", "optical depth",
          {0, 20, 1e4, 3e38, INFINITY}, 0.03, {"e^D / (1 + e^D)", test::kWrong}) {
  PixelGrid grid{.first_x = 2, .first_y = 2, .step_x = 3, .step_y = 3, .cols = 3, .rows = 3};
  std::vector<float> depth(9, float(h));
  depth[std::size_t(random.below(9))] = 0;
  ImageF weight(10, 10, 1);
  density_weights({}, {grid, {0.5, 0.5, 9.5, 9.5}, depth}, weight);
  for (const float w : weight.data) worst.ours_is(w >= 0.5f && w <= 1.f);
  const std::vector<float> even(9, float(h));
  density_weights({}, {grid, {0.5, 0.5, 9.5, 9.5}, even}, weight);
  worst.ours(weight.at(4, 4), 1 / (1 + std::exp(-Real(h))));
  worst.naive(std::exp(even[0]) / (1 + std::exp(even[0])), 1 / (1 + std::exp(-Real(h))));
}

}  // namespace ngs
