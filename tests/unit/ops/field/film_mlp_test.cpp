#include "ngs/ops/field/film_mlp.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/field/film_mlp_kernels.h"
#include "support/random.h"

namespace ngs {
namespace {

struct Net {
  FilmMlpConfig config;
  ParamStore store;
  std::size_t offset;
  std::vector<float> feature, condition, direction;
  std::int64_t queries;

  Net(const FilmMlpConfig& c, std::int64_t n, std::uint64_t seed) : config(c), queries(n) {
    store.add("something.else", {3});  // so that the network does not start at 0
    offset = add_film_mlp(store, "film", c, {seed, -2});
    test::Random random(seed);
    feature = random.uniform_vector<float>(std::size_t(n * c.inputs), -1, 1);
    condition = random.uniform_vector<float>(std::size_t(n * c.condition), 0, 1);
    for (std::int64_t r = 0; r < n; ++r) direction.insert(direction.end(), {0.36f, 0.48f, 0.8f});
  }
  FilmMlpInputs inputs() const {
    return {{feature.data(), queries, config.inputs},
            {condition.data(), queries, config.condition},
            {direction.data(), queries},
            1};
  }
};

}  // namespace

TEST_CASE("film mlp equals the formulas written out for one neuron") {
  Net net({.inputs = 1, .condition = 1, .hidden = 1, .layers = 2, .direction_degree = 0}, 1, 1);
  net.feature = {2};
  net.condition = {0.5f};
  // per layer: W b Wγ bγ Wβ bβ; then head weight [4], head bias [4]
  const float p[] = {0.5f, 0.25f, 1,    1,  0.5f,  -0.25f, 2,    -1,   -1,   1,
                     1,    0.5f,  0.5f, -1, 0.25f, 1,      0.1f, 0.2f, 0.3f, 0.4f};
  std::copy(std::begin(p), std::end(p), net.store.values.begin() + std::ptrdiff_t(net.offset));
  const double h0 = 0.5 * 2 + 0.25, x1 = (0.5 + 1) * h0 + 0.25 - 0.25, h1 = 2 * x1 - 1,
               x2 = (-0.5 + 1) * h1 + 0.5 + 0.5;
  FilmMlpOutput out;
  FilmMlp(net.config, net.offset, 0.5).forward({}, net.store, net.inputs(), out);
  CHECK(double(out.density[0]) == doctest::Approx(2 * std::log1p(std::exp(0.5 * x2 + 0.1))).epsilon(1e-6));
  CHECK(double(out.rgb[0]) == doctest::Approx(1 / (1 + std::exp(x2 - 0.2))).epsilon(1e-6));
  CHECK(double(out.rgb[1]) == doctest::Approx(1 / (1 + std::exp(-(0.25 * x2 + 0.3)))).epsilon(1e-6));
  CHECK(double(out.rgb[2]) == doctest::Approx(1 / (1 + std::exp(-(x2 + 0.4)))).epsilon(1e-6));
}

TEST_CASE("film mlp: initial modulation is the identity for a zero condition") {
  const Net net({}, 1, 2);
  const FilmMlpLayout at = film_mlp_layout(net.config);
  for (int l = 0; l < 2; ++l)
    for (std::size_t i = 0; i < 64; ++i) {
      CHECK(net.store.values[net.offset + at.layer[l].gamma_bias + i] == 1);
      CHECK(net.store.values[net.offset + at.layer[l].beta_bias + i] == 0);
    }
  CHECK(net.store.values[net.offset + at.head_bias] == -2);
}

TEST_CASE("film mlp: packed float results agree with the same kernels in double") {
  for (const std::int64_t n : {1, 95, 96, 97, 1000}) {
    CAPTURE(n);
    Net net({}, n, 3);
    FilmMlpOutput out;
    const FilmMlp mlp(net.config, net.offset, 0.1);
    mlp.forward({}, net.store, net.inputs(), out);
    test::Random random(4);
    const auto gd = random.uniform_vector<float>(std::size_t(n), -1, 1),
               gc = random.uniform_vector<float>(std::size_t(n) * 3, -1, 1);
    FilmMlpGradients grads;
    mlp.backward({}, net.store, net.inputs(), {out, gd, gc}, grads);

    const auto wide = [](const std::vector<float>& v) { return std::vector<double>(v.begin(), v.end()); };
    const auto params = wide({net.store.values.begin() + std::ptrdiff_t(net.offset), net.store.values.end()});
    const auto x = wide(net.feature), c = wide(net.condition), d = wide(net.direction), ugd = wide(gd), ugc = wide(gc);
    std::vector<double> density(std::size_t(n), 0.0), rgb(std::size_t(n) * 3),
        context(film_context_size<double>(net.config));
    std::vector<double> gp(params.size()), gx(x.size()), gcond(c.size());
    FilmMlpData<double> data;
    data.params = params.data();
    data.input = {x.data(), n, 16};
    data.condition = {c.data(), n, 3};
    data.direction = {d.data(), n};
    data.density_scale = double(float(1 / 0.1));
    data.density = density.data();
    data.rgb = rgb.data();
    FilmMlpBlock<double> block(net.config);
    for (std::int64_t b = 0; b < (n + 11) / 12; ++b) {
      block.forward(data, b, context.data());
      block.backward(data, {ugd.data(), ugc.data(), gx.data(), gcond.data()}, b, context.data(), gp.data());
    }
    // Sums of 64 products: measured worst 4e-6 of the largest value; a wrong lane is off by order 1.
    const auto close = [](const auto& got, const std::vector<double>& want, std::size_t offset = 0) {
      double largest = 0, worst = 0;
      for (const double w : want) largest = std::max(largest, std::abs(w));
      for (std::size_t i = 0; i < want.size(); ++i)
        worst = std::max(worst, std::abs(double(got[offset + i]) - want[i]));
      return worst <= 1e-5 * largest;
    };
    CHECK(close(out.density, density));
    CHECK(close(out.rgb, rgb));
    CHECK(close(grads.feature, gx));
    CHECK(close(grads.condition, gcond));
    CHECK(close(net.store.grads, gp, net.offset));
    CHECK(net.store.grads[0] == 0);
  }
}

TEST_CASE("film mlp gives the same bytes for 1 and 7 threads, gradients included") {
  test::Random random(6);
  const auto gd = random.uniform_vector<float>(5000, -1, 1), gc = random.uniform_vector<float>(15000, -1, 1);
  const auto bytes = [&](int threads) {
    Net net({}, 5000, 5);
    const FilmMlp mlp(net.config, net.offset, 0.1);
    FilmMlpOutput out;
    mlp.forward({.threads = threads}, net.store, net.inputs(), out);
    FilmMlpGradients grads;
    mlp.backward({.threads = threads}, net.store, net.inputs(), {out, gd, gc}, grads);
    return std::vector{out.density, out.rgb, grads.feature, grads.condition, net.store.grads};
  };
  CHECK(bytes(1) == bytes(7));
}

TEST_CASE("film mlp of no queries is empty") {
  Net net({}, 0, 7);
  FilmMlpOutput out;
  const FilmMlp mlp(net.config, net.offset, 1);
  mlp.forward({}, net.store, net.inputs(), out);
  FilmMlpGradients grads;
  mlp.backward({}, net.store, net.inputs(), {out, {}, {}}, grads);
  CHECK(out.density.empty());
  CHECK(net.store.grads == std::vector<float>(net.store.grads.size(), 0.f));
}

}  // namespace ngs
