// Adjoint test of the whole view: <u, J v> = <Jᵀ u, v>. J v is the forward pass on dual numbers, Jᵀ u the backward
// pass in double; both are exact up to rounding, so there is no step size and the tolerance is 1e-11.
#include <doctest/doctest.h>

#include <cmath>

#include "support/adjoint.h"
#include "support/splat_case.h"

namespace ngs {
namespace {

using test::SplatArrays;
using D = Dual<double>;

template <class T>
std::vector<Plane<T>> planes_of(std::vector<std::vector<std::remove_const_t<T>>>& images) {
  std::vector<Plane<T>> out;
  for (auto& image : images) out.push_back({image.data(), 1});
  return out;
}

double rng(std::uint64_t seed, std::uint64_t& index) { return 2 * rng_uniform(seed, RngStream::kTest, index++) - 1; }

struct AdjointResult {
  double u_Jv, JTu_v;
};

AdjointResult adjoint(std::uint64_t seed, const SplatOptions& options, int only_parameter, double spread) {
  const test::SplatCase c = test::splat_case(seed, 60, 37, 29, spread);
  const Exec exec{.threads = 1};
  SplatArrays<double> plain(c);
  SplatArrays<D> dual(c);
  std::uint64_t index = 1u << 20;
  std::vector<std::vector<double>> direction;
  const auto parameters = dual.parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    std::vector<double>& v = direction.emplace_back();
    for (D& x : *parameters[p])
      x.d = v.emplace_back(only_parameter < 0 || only_parameter == int(p) ? rng(seed, index) : 0.0);
  }
  const Vec3<double> background{0.3, 0.1, 0.8};
  const std::size_t pixels = 37 * 29;
  const int count = plain.request(background).count();
  std::vector<std::vector<D>> image(std::size_t(count) + 1, std::vector<D>(pixels));
  SplatEngine<D> forward(tile_kernels_of<D>(), options, dual.cloud(), c.camera, dual.request(background));
  forward.forward(exec, planes_of<D>(image));

  std::vector<std::vector<double>> u(image.size(), std::vector<double>(pixels)), out = u;
  AdjointResult r{0, 0};
  for (std::size_t k = 0; k < u.size(); ++k)
    for (std::size_t i = 0; i < pixels; ++i) {
      u[k][i] = rng(seed, index);
      r.u_Jv += u[k][i] * image[k][i].d;
    }

  SplatEngine<double> engine(tile_kernels_of<double>(), options, plain.cloud(), c.camera, plain.request(background));
  engine.forward(exec, planes_of<double>(out));
  std::vector<std::vector<double>> grad;
  for (const auto* p : plain.parameters()) grad.emplace_back(p->size(), NAN);
  engine.backward(
      exec, planes_of<const double>(u), std::vector<std::uint8_t>(std::size_t(count), 1),
      {grad[0].data(), grad[1].data(), grad[2].data(), grad[3].data(), grad[4].data(), grad[5].data(), grad[6].data()});
  for (std::size_t p = 0; p < grad.size(); ++p)
    for (std::size_t i = 0; i < grad[p].size(); ++i) r.JTu_v += grad[p][i] * direction[p][i];
  return r;
}

}  // namespace

TEST_CASE("splat: backward equals the adjoint of forward for every parameter") {
  const char* names[] = {"position", "rotation", "log_scale", "logit_opacity", "sh_dc", "sh_rest", "label"};
  for (const Compat compat : {Compat::kInria, Compat::kGsplat})
    for (const bool antialiased : {false, true})
      for (const double spread : {1.0, 2.5})  // 2.5: centres beyond the limits of the Jacobian
        for (int parameter = 0; parameter < 7; ++parameter) {
          CAPTURE(names[parameter]);
          CAPTURE(antialiased);
          CAPTURE(spread);
          const AdjointResult r = adjoint(std::uint64_t(17 + parameter), {compat, antialiased, 3}, parameter, spread);
          CHECK(std::abs(r.u_Jv) > 1e-3);  // the direction matters
          CHECK(test::adjoint_difference(r.u_Jv, r.JTu_v) < 1e-11);
        }
}

TEST_CASE("splat: a channel that must not move geometry has no gradient of geometry") {
  const test::SplatCase c = test::splat_case(5, 40, 33, 20);
  SplatArrays<double> a(c);
  const Exec exec{.threads = 1};
  std::vector<std::vector<double>> out(7, std::vector<double>(33 * 20)), u(7, std::vector<double>(33 * 20, 0.0));
  std::fill(u[3].begin(), u[3].end(), 1.0);  // the first label channel only
  SplatEngine<double> engine(tile_kernels_of<double>(), {}, a.cloud(), c.camera, a.request({0, 0, 0}));
  engine.forward(exec, planes_of<double>(out));
  std::vector<double> opacity(40), label(80);
  CloudGradientView<double> grad{.logit_opacity = opacity.data(), .label = label.data()};
  std::vector<std::uint8_t> moves{1, 1, 1, 0, 0, 1};
  engine.backward(exec, planes_of<const double>(u), moves, grad);
  double label_sum = 0;
  for (int i = 0; i < 40; ++i) {
    CHECK(opacity[std::size_t(i)] == 0.0);
    label_sum += label[std::size_t(i) * 2];
  }
  CHECK(label_sum > 0);
  moves[3] = 1;
  engine.backward(exec, planes_of<const double>(u), moves, grad);
  CHECK(std::any_of(opacity.begin(), opacity.end(), [](double g) { return g != 0; }));
}

}  // namespace ngs
