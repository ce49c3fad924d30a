// Mutants this kills: γ and β exchanged, the inner ReLU of layer 0 at other layers, a missing bias gradient,
// the direction weights without their SH basis, columns of a partial last block that are counted.
#include <doctest/doctest.h>

#include "ngs/ops/field/film_mlp_kernels.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

struct FilmCase {
  FilmMlpConfig config;
  std::int64_t queries;
  std::vector<double> params, input, condition, direction;

  FilmCase(test::Random& random, const FilmMlpConfig& c, std::int64_t n)
      : config(c),
        queries(n),
        params(random.uniform_vector(film_mlp_layout(c).size, -0.6, 0.6)),
        input(random.uniform_vector(std::size_t(n * c.inputs), -1, 1)),
        condition(random.uniform_vector(std::size_t(n * c.condition), 0, 1)) {
    for (std::int64_t ray = 0; ray < (n + 1) / 2; ++ray) {
      const double z = random.uniform(-1, 1), phi = random.uniform(0, 6.28), r = std::sqrt(1 - z * z);
      direction.insert(direction.end(), {r * std::cos(phi), r * std::sin(phi), z});
    }
  }

  template <class T>
  struct Run {
    std::vector<T> density, rgb, context;
  };
  template <class T>
  FilmMlpData<T> data(const std::vector<T>& p, const std::vector<T>& x, const std::vector<T>& c,
                      const std::vector<T>& d) const {
    FilmMlpData<T> data;
    data.params = p.data();
    data.input = {x.data(), queries, config.inputs};
    data.condition = {c.data(), queries, config.condition};
    data.direction = {d.data(), std::int64_t(d.size() / 3)};
    data.queries_per_direction = 2;
    data.density_scale = T(3);
    return data;
  }
  template <class T>
  std::int64_t blocks() const {
    return (queries + kBlockColumns<T> - 1) / kBlockColumns<T>;
  }
  template <class T>
  Run<T> forward(const std::vector<T>& p, const std::vector<T>& x, const std::vector<T>& c) const {
    const auto d = test::constant<T>(direction);
    const std::size_t kept = film_context_size<T>(config);
    Run<T> run{std::vector<T>(std::size_t(queries)), std::vector<T>(std::size_t(queries) * 3),
               std::vector<T>(kept * std::size_t(blocks<T>()))};
    FilmMlpData<T> io = data(p, x, c, d);
    io.density = run.density.data();
    io.rgb = run.rgb.data();
    FilmMlpBlock<T> block(config);
    for (std::int64_t b = 0; b < blocks<T>(); ++b) block.forward(io, b, &run.context[std::size_t(b) * kept]);
    return run;
  }
  struct Grads {
    std::vector<double> params, input, condition;
  };
  Grads backward(const std::vector<double>& u_density, const std::vector<double>& u_rgb) const {
    const Run<double> run = forward(params, input, condition);
    Grads g{std::vector<double>(params.size()), std::vector<double>(input.size()),
            std::vector<double>(condition.size())};
    const std::size_t kept = film_context_size<double>(config);
    FilmMlpBlock<double> block(config);
    for (std::int64_t b = 0; b < blocks<double>(); ++b)
      block.backward(data(params, input, condition, direction),
                     {u_density.data(), u_rgb.data(), g.input.data(), g.condition.data()}, b,
                     &run.context[std::size_t(b) * kept], g.params.data());
    return g;
  }
};

}  // namespace

TEST_CASE("film mlp: backward equals the adjoint of forward for weights, features and condition") {
  test::Random random(31);
  const FilmMlpConfig configs[] = {{.inputs = 5, .condition = 3, .hidden = 16, .layers = 2, .direction_degree = 2},
                                   {.inputs = 1, .condition = 1, .hidden = 7, .layers = 1, .direction_degree = 0},
                                   {.inputs = 20, .condition = 4, .hidden = 17, .layers = 4, .direction_degree = 3}};
  for (const FilmMlpConfig& config : configs)
    for (const std::int64_t n : {1, 12, 31}) {  // one lane per query: blocks of 12, so 31 is 2 blocks and a remainder
      CAPTURE(config.hidden);
      CAPTURE(n);
      const FilmCase c(random, config, n);
      const auto u_density = random.uniform_vector(std::size_t(n), -1, 1),
                 u_rgb = random.uniform_vector(std::size_t(n) * 3, -1, 1);
      const auto vp = random.uniform_vector(c.params.size(), -1, 1), vx = random.uniform_vector(c.input.size(), -1, 1);
      const auto vc = random.uniform_vector(c.condition.size(), -1, 1);
      const auto g = c.backward(u_density, u_rgb);
      const auto constant = [](const std::vector<double>& x) { return test::constant<test::DualD>(x); };
      const auto check = [&](const FilmCase::Run<test::DualD>& dual, double jtu_v) {
        const double u_jv = test::dot(u_density, test::deriv(dual.density)) + test::dot(u_rgb, test::deriv(dual.rgb));
        CHECK(test::adjoint_difference(u_jv, jtu_v) < 1e-11);
      };
      check(c.forward(test::seed(c.params, vp), constant(c.input), constant(c.condition)), test::dot(g.params, vp));
      check(c.forward(constant(c.params), test::seed(c.input, vx), constant(c.condition)), test::dot(g.input, vx));
      check(c.forward(constant(c.params), constant(c.input), test::seed(c.condition, vc)), test::dot(g.condition, vc));
    }
}

TEST_CASE("film mlp: the weight gradient agrees with extrapolated finite differences") {
  test::Random random(32);
  const FilmCase c(random, {.inputs = 4, .condition = 2, .hidden = 8, .layers = 2, .direction_degree = 1}, 5);
  const auto u_density = random.uniform_vector(5, -1, 1), u_rgb = random.uniform_vector(15, -1, 1);
  const auto v = random.uniform_vector(c.params.size(), -1, 1);
  const auto along = [&](double t) {
    const auto run = c.forward(test::moved(c.params, v, t), c.input, c.condition);
    return test::dot(u_density, run.density) + test::dot(u_rgb, run.rgb);
  };
  CHECK(test::ridders_difference(test::ridders(along, 1e-3), test::dot(c.backward(u_density, u_rgb).params, v)) < 1e-8);
}

}  // namespace ngs
