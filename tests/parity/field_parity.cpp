// Device against CPU: k-NN, RBF, hash grid, FiLM network and volume rendering.
#include "ngs/core/rng.h"
#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/field/rbf.h"
#include "ngs/ops/field/volume.h"
#include "ngs/ops/neighbours/knn.h"
#include "parity/backends.h"
#include "support/random.h"

namespace ngs::test {
namespace {

Rows<const float, 3> rows3(const std::vector<float>& v) { return {v.data(), std::int64_t(v.size() / 3)}; }

std::vector<float> random_points(std::uint64_t seed, std::int64_t n, double side) {
  return Random(seed).uniform_vector<float>(std::size_t(n) * 3, -side, side);
}

/// Points on a lattice: many equal distances.
std::vector<float> lattice_points(std::int64_t n) {
  std::vector<float> p;
  for (std::int64_t i = 0; i < n; ++i) p.insert(p.end(), {float(i % 7), float(i / 7 % 5), float(i / 35)});
  return p;
}

void same_graph(const KnnGraph& got, const KnnGraph& want) {
  CHECK(got.neighbours == want.neighbours);
  CHECK(got.points == want.points);
  CHECK(got.index == want.index);
  CHECK(got.dist2 == want.dist2);
  CHECK(got.row_begin == want.row_begin);
  CHECK(got.edge == want.edge);
}

}  // namespace

TEST_CASE("knn: a device finds the same neighbours as the CPU, ties included") {
  for (const Backend& b : backends())
    for (const int neighbours : {1, 8, 9, 32})
      for (const std::int64_t points : {0, 1, 8, 9, 255, 700}) {  // 256 points are a tile
        CAPTURE(neighbours);
        CAPTURE(points);
        const std::vector<float> random = random_points(1, points, 1), lattice = lattice_points(points);
        for (const std::int64_t queries : {0, 1, 127, 300}) {  // 128 queries are a block
          const std::vector<float> q = random_points(2, queries, 1.5);
          same_graph(nearest_points(b.exec, rows3(random), rows3(q), neighbours),
                     nearest_points({}, rows3(random), rows3(q), neighbours));
        }
        same_graph(nearest_others(b.exec, rows3(lattice), neighbours), nearest_others({}, rows3(lattice), neighbours));
        const std::vector<float> far = random_points(3, points, 1e25);  // squares overflow float, not double
        same_graph(nearest_others(b.exec, rows3(far), neighbours), nearest_others({}, rows3(far), neighbours));
      }
}

TEST_CASE("rbf: values and gradients of a device equal the CPU's within rounding") {
  for (const Backend& b : backends())
    for (const std::int64_t points : {0, 1, 300}) {
      Random random(3);
      const std::vector<float> q = random_points(4, 900, 1.5), x = random_points(5, points, 1);
      const auto feature = random.uniform_vector<float>(std::size_t(points) * 3, 0, 1),
                 upstream = random.uniform_vector<float>(2700, -1, 1);
      const KnnGraph graph = nearest_points({}, rows3(x), rows3(q), 8);
      const RbfProblem problem{rows3(q), rows3(x), {feature.data(), points, 3}, &graph, 0.35};
      RbfField want, got;
      rbf_forward({}, problem, want);
      rbf_forward(b.exec, problem, got);
      std::vector<float> want_grad, got_grad;
      rbf_backward({}, problem, want, {upstream.data(), 900, 3}, want_grad);
      rbf_backward(b.exec, problem, want, {upstream.data(), 900, 3}, got_grad);
      // exp at exponents up to some tens: 2 ulp and the exponent's own rounding
      check_ratio(b, "rbf weight", worst_ratio(got.weight, want.weight, 1), 64);
      check_ratio(b, "rbf feature", worst_ratio(got.feature, want.feature, 1), 64);
      check_ratio(b, "rbf gradient of features", worst_ratio(got_grad, want_grad, std::max(1.0, largest(want_grad))),
                  8);
      if (b.same_functions) CHECK(got.feature == want.feature);
    }
}

TEST_CASE("hash grid: values and gradients of a device equal the CPU's bit for bit") {
  for (const Backend& b : backends())
    for (const int features : {1, 2, 4, 8}) {
      HashGridConfig config{
          .levels = 5, .features = features, .log2_table = 9, .base_resolution = 4, .max_resolution = 60};
      const std::vector<float> p = random_points(6, 333, 1.3);  // some outside the box
      ParamStore store;
      const std::size_t offset = add_hash_grid(store, "hash", config, 1);
      Random random(7);
      for (float& v : store.values) v = float(random.uniform(-1, 1));
      for (float& v : store.grads) v = float(random.uniform(-1, 1));  // the backward pass adds
      ParamStore other = store;
      const HashGrid grid(config, {{0, 0, 0}, {0.5f, 0.5f, 0.5f}}, offset);
      std::vector<float> want, got;
      grid.forward({}, store, rows3(p), want);
      grid.forward(b.exec, store, rows3(p), got);
      const auto upstream = random.uniform_vector<float>(want.size(), -1, 1);
      grid.backward({}, store, rows3(p), upstream);
      grid.backward(b.exec, other, rows3(p), upstream);
      CAPTURE(features);
      CHECK(got == want);
      CHECK(other.grads == store.grads);
    }
}

TEST_CASE("hash grid: atomic sums of a device equal ordered sums within the rounding of their terms") {
  for (const int features : {1, 2, 4, 8}) {
    const HashGridConfig config{
        .levels = 5, .features = features, .log2_table = 9, .base_resolution = 4, .max_resolution = 60};
    const std::vector<float> p = random_points(6, 333, 1.3);
    ParamStore empty;
    const std::size_t offset = add_hash_grid(empty, "hash", config, 1);
    const HashGrid grid(config, {{0, 0, 0}, {0.5f, 0.5f, 0.5f}}, offset);
    const auto upstream = Random(7).uniform_vector<float>(333 * std::size_t(config.outputs()), -1, 1);
    const auto table_gradient = [&](const Exec& exec, std::vector<float> up) {
      ParamStore store = empty;
      grid.backward(exec, store, rows3(p), up);
      return store.grads;
    };
    std::vector<float> positive = upstream;
    for (float& u : positive) u = std::abs(u);
    const std::vector<float> ordered = table_gradient({}, upstream),
                             terms = table_gradient({}, positive);  // weights are >= 0
    std::vector<int> count(ordered.size());
    for (const HashLevel& level : grid.levels())
      for (std::int64_t q = 0; q < 333; ++q)
        for (const std::uint32_t entry : hash_cell(level, grid.box(), vec3(rows3(p).row(q))).entry)
          for (int f = 0; f < features; ++f) ++count[offset + entry * std::size_t(features) + std::size_t(f)];
    // Either sum rounds n - 1 times, each time by half an eps of at most the sum of its terms' magnitudes.
    const auto worst_share = [&](const std::vector<float>& got) {
      double worst = 0;
      for (std::size_t i = 0; i < got.size(); ++i)
        if (const double error = std::abs(double(got[i]) - double(ordered[i])); error > 0)
          worst =
              std::max(worst, error / (count[i] * double(std::numeric_limits<float>::epsilon()) * double(terms[i])));
      return worst;
    };
    CAPTURE(features);
    for (const Backend& b : atomic_backends()) {
      check_ratio(b, "hash gradient, atomic sums", worst_share(table_gradient(b.exec, upstream)), 1);
      std::vector<float> without = upstream;  // the bound must detect a query that is left out in one level
      std::fill_n(without.begin() + 100 * config.outputs(), features, 0.f);
      CHECK(worst_share(table_gradient(b.exec, without)) > 1000);
    }
    if (atomic_backends().size() > 1)
      CHECK(table_gradient(atomic_backends()[0].exec, upstream) != table_gradient(atomic_backends()[1].exec, upstream));
  }
}

TEST_CASE("film mlp: values and gradients of a device equal the CPU's within rounding") {
  struct Case {
    FilmMlpConfig config;
    std::int64_t queries, per_direction;
  };
  // one partial tile, tiles and a remainder, every tile width, more tiles than parts of the parameter sum
  const Case cases[] = {{{16, 3, 64, 2, 2}, 1, 1}, {{16, 3, 64, 2, 2}, 1000, 8}, {{32, 3, 128, 3, 3}, 100, 4},
                        {{6, 1, 16, 1, 0}, 65, 1}, {{128, 4, 16, 4, 1}, 200, 5}, {{3, 3, 33, 2, 2}, 9000, 8}};
  for (const Backend& b : backends())
    for (const Case& c : cases) {
      if (b.same_functions && c.queries > 5000 && &b != &backends()[0]) continue;
      Random random(8);
      ParamStore store;
      const std::size_t offset = add_film_mlp(store, "film", c.config, {.seed = 2});
      for (float& v : store.values) v += float(random.uniform(-0.1, 0.1));
      for (float& v : store.grads) v = float(random.uniform(-1, 1));
      ParamStore other = store;
      const auto n = std::size_t(c.queries);
      const auto feature = random.uniform_vector<float>(n * std::size_t(c.config.inputs), -1, 1),
                 condition = random.uniform_vector<float>(n * std::size_t(c.config.condition), 0, 1);
      std::vector<float> direction;
      for (std::int64_t r = 0; r * c.per_direction < c.queries; ++r) {
        const Vec3<double> d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)};
        const double inv = 1 / std::sqrt(dot(d, d));
        direction.insert(direction.end(), {float(inv * d.x), float(inv * d.y), float(inv * d.z)});
      }
      const FilmMlpInputs in{{feature.data(), c.queries, c.config.inputs},
                             {condition.data(), c.queries, c.config.condition},
                             rows3(direction),
                             c.per_direction};
      const FilmMlp mlp(c.config, offset, 0.5);
      FilmMlpOutput want, got;
      mlp.forward({}, store, in, want);
      mlp.forward(b.exec, store, in, got);
      const auto grad_density = random.uniform_vector<float>(n, -1, 1),
                 grad_rgb = random.uniform_vector<float>(n * 3, -1, 1);
      FilmMlpGradients want_grad, got_grad;
      mlp.backward({}, store, in, {want, grad_density, grad_rgb}, want_grad);
      mlp.backward(b.exec, other, in, {got, grad_density, grad_rgb}, got_grad);
      CAPTURE(c.config.hidden);
      CAPTURE(c.queries);
      check_ratio(b, "film density", worst_ratio(got.density, want.density, std::max(1.0, largest(want.density))), 4);
      check_ratio(b, "film colour", worst_ratio(got.rgb, want.rgb, 1), 4);
      check_ratio(b, "film gradient of inputs",
                  worst_ratio(got_grad.feature, want_grad.feature, std::max(1.0, largest(want_grad.feature))), 64);
      check_ratio(b, "film gradient of conditions",
                  worst_ratio(got_grad.condition, want_grad.condition, std::max(1.0, largest(want_grad.condition))),
                  64);
      // sums over all queries, in another order
      check_ratio(b, "film gradient of parameters",
                  worst_ratio(other.grads, store.grads, std::max(1.0, largest(store.grads))), 64);
      if (!b.same_functions) continue;
      CHECK(got.density == want.density);
      CHECK(got.rgb == want.rgb);
    }
}

TEST_CASE("volume: values and gradients of a device equal the CPU's within rounding") {
  for (const Backend& b : backends())
    for (const int samples : {0, 1, 8}) {
      constexpr std::int64_t kRays = 300;
      Random random(9);
      const auto n = std::size_t(kRays * samples);
      const auto density = random.uniform_vector<float>(n, 0, 40), rgb = random.uniform_vector<float>(n * 3, 0, 1),
                 spacing = random.uniform_vector<float>(kRays, 0, 0.3),
                 up_colour = random.uniform_vector<float>(kRays * 3, -1, 1),
                 up_alpha = random.uniform_vector<float>(kRays, -1, 1),
                 up_depth = random.uniform_vector<float>(kRays, -1, 1);
      const VolumeInputs in{samples, density.data(), rgb.data(), spacing.data(), kRays, {0.1f, 0.2f, 0.3f}};
      VolumeOutput want, got;
      volume_forward({}, in, want);
      volume_forward(b.exec, in, got);
      for (const bool with_depth : {false, true}) {
        VolumeGradients want_grad, got_grad;
        const std::vector<float> depth_or_none = with_depth ? up_depth : std::vector<float>{};
        volume_backward({}, in, want, {up_colour, up_alpha, depth_or_none}, want_grad);
        volume_backward(b.exec, in, want, {up_colour, up_alpha, depth_or_none}, got_grad);
        check_ratio(b, "volume gradient of density", worst_ratio(got_grad.density, want_grad.density, 1), 4);
        check_ratio(b, "volume gradient of colour", worst_ratio(got_grad.rgb, want_grad.rgb, 1), 4);
      }
      check_ratio(b, "volume colour", worst_ratio(got.colour, want.colour, 1), 16);
      check_ratio(b, "volume alpha", worst_ratio(got.alpha, want.alpha, 1), 4);
      check_ratio(b, "volume optical depth",
                  worst_ratio(got.optical_depth, want.optical_depth, std::max(1.0, largest(want.optical_depth))), 1);
      if (b.same_functions) CHECK(got.colour == want.colour);
    }
}

}  // namespace ngs::test
