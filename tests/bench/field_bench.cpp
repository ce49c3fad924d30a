// Ops of the joint stage other than the splat: neighbours, interpolation, encoding, network, volume, photometric loss.
// "GFLOP/s" counts multiplications and additions of the matrix products only, two per weight and query.
#include <benchmark/benchmark.h>

#include "ngs/ops/field/film_mlp.h"
#include "ngs/ops/field/hash_grid.h"
#include "ngs/ops/field/rbf.h"
#include "ngs/ops/field/volume.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/random.h"

namespace ngs::bench {
namespace {

constexpr std::int64_t kQueries = 32768, kBoundary = 4000, kRays = kQueries / 8;

void per_query(benchmark::State& state) {
  state.counters["queries/s"] = benchmark::Counter(double(kQueries), benchmark::Counter::kIsIterationInvariantRate);
}

std::vector<float> uniform(std::uint64_t seed, std::int64_t n, double lo, double hi) {
  return test::Random(seed).uniform_vector<float>(std::size_t(n), lo, hi);
}

void neighbours(benchmark::State& state) {
  const std::vector<float> points = uniform(1, 3 * kBoundary, -1, 1), queries = uniform(2, 3 * kQueries, -1, 1);
  for (auto unused : state)
    benchmark::DoNotOptimize(nearest_points({}, {points.data(), kBoundary}, {queries.data(), kQueries}, 8).index[0]);
  per_query(state);
}

void interpolation(benchmark::State& state) {
  const std::vector<float> points = uniform(1, 3 * kBoundary, -1, 1), queries = uniform(2, 3 * kQueries, -1, 1),
                           feature = uniform(3, 3 * kBoundary, 0, 1);
  const KnnGraph graph = nearest_points({}, {points.data(), kBoundary}, {queries.data(), kQueries}, 8);
  const RbfProblem problem{
      {queries.data(), kQueries}, {points.data(), kBoundary}, {feature.data(), kBoundary, 3}, &graph, 0.1};
  RbfField field;
  for (auto unused : state) rbf_forward({}, problem, field);
  per_query(state);
}

struct Encoding {
  HashGridConfig config;
  ParamStore store;
  std::vector<float> points = uniform(4, 3 * kQueries, -1, 1), out;
  HashGrid grid;
  Encoding() : grid(config, hash_box({points.data(), kQueries}, 0.0), add_hash_grid(store, "hash", config, 1)) {}
};

void hash_forward(benchmark::State& state) {
  Encoding e;
  for (auto unused : state) e.grid.forward({}, e.store, {e.points.data(), kQueries}, e.out);
  per_query(state);
}

void hash_backward(benchmark::State& state) {
  Encoding e;
  const std::vector<float> gradient = uniform(5, kQueries * e.config.outputs(), -1, 1);
  for (auto unused : state) e.grid.backward({}, e.store, {e.points.data(), kQueries}, gradient);
  per_query(state);
}

struct Network {
  FilmMlpConfig config;
  ParamStore store;
  std::size_t offset = add_film_mlp(store, "film", config, {});
  FilmMlp mlp{config, offset, 1.0};
  std::vector<float> feature = uniform(6, kQueries*config.inputs, -1, 1),
                     condition = uniform(7, kQueries*config.condition, 0, 1);
  std::vector<float> direction;
  Network() {
    for (std::int64_t r = 0; r < kRays; ++r) direction.insert(direction.end(), {0.36f, 0.48f, 0.8f});
  }
  FilmMlpInputs inputs() const {
    return {{feature.data(), kQueries, config.inputs},
            {condition.data(), kQueries, config.condition},
            {direction.data(), kRays},
            8};
  }
  /// Multiplications and additions of one forward pass.
  double flop() const {
    double weights = 4.0 * config.hidden;
    for (int l = 0; l < config.layers; ++l)
      weights += config.hidden * double((l == 0 ? config.inputs : config.hidden) + 2 * config.condition);
    return 2 * weights * double(kQueries);
  }
  void count(benchmark::State& state, double passes) const {
    per_query(state);
    state.counters["GFLOP/s"] =
        benchmark::Counter(1e-9 * passes * flop(), benchmark::Counter::kIsIterationInvariantRate);
  }
};

void network_forward(benchmark::State& state) {
  const Network n;
  FilmMlpOutput out;
  for (auto unused : state) n.mlp.forward({}, n.store, n.inputs(), out);
  n.count(state, 1);
}

void network_backward(benchmark::State& state) {
  Network n;
  FilmMlpOutput out;
  n.mlp.forward({}, n.store, n.inputs(), out);
  const std::vector<float> density(std::size_t(kQueries), 0.1f), rgb(std::size_t(3 * kQueries), 0.1f);
  FilmMlpGradients grads;
  for (auto unused : state) {
    n.mlp.backward({}, n.store, n.inputs(), {out, density, rgb}, grads);
    benchmark::DoNotOptimize(grads.feature[0]);
  }
  n.count(state, 2);  // gradients of inputs and of weights
}

void volume(benchmark::State& state) {
  const std::vector<float> density = uniform(8, kQueries, 0, 3), rgb = uniform(9, 3 * kQueries, 0, 1),
                           spacing = uniform(10, kRays, 0.1, 0.2);
  const VolumeInputs in{8, density.data(), rgb.data(), spacing.data(), kRays, {0, 0, 0}};
  const std::vector<float> colour(std::size_t(3 * kRays), 0.1f), alpha(std::size_t(kRays), 0.1f);
  VolumeOutput out;
  VolumeGradients gradients;
  for (auto unused : state) {
    volume_forward({}, in, out);
    volume_backward({}, in, out, {colour, alpha, {}}, gradients);
  }
  per_query(state);
}

void photometric(benchmark::State& state) {
  ImageF a(512, 384, 3), b(512, 384, 3), gradient;
  a.data = uniform(11, std::int64_t(a.data.size()), 0, 1), b.data = uniform(12, std::int64_t(b.data.size()), 0, 1);
  PhotometricPass<float> pass;
  for (auto unused : state) benchmark::DoNotOptimize(pass.evaluate({}, {}, {a, b}, &gradient).total);
  state.counters["pixels/s"] = benchmark::Counter(double(a.pixels()), benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(neighbours)->Unit(benchmark::kMillisecond);
BENCHMARK(interpolation)->Unit(benchmark::kMillisecond);
BENCHMARK(hash_forward)->Unit(benchmark::kMillisecond);
BENCHMARK(hash_backward)->Unit(benchmark::kMillisecond);
BENCHMARK(network_forward)->Unit(benchmark::kMillisecond);
BENCHMARK(network_backward)->Unit(benchmark::kMillisecond);
BENCHMARK(volume)->Unit(benchmark::kMillisecond);
BENCHMARK(photometric)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ngs::bench
