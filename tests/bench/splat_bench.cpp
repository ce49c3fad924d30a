// Compositing forward and backward, and the evidence of one view. A pair is a (pixel, Gaussian) combination that
// contributes: alpha >= 1/255 and the pixel is not saturated. Idle lanes do not count, so that rates of different
// vector widths are comparable. "view": includes projection and tile lists.
#include <benchmark/benchmark.h>

#include "bench/bench_scene.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/ops/splat/splat_engine.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/tile_kernels_of.h"
#include "support/projected_view.h"

namespace ngs::bench {
namespace {

const BenchScene& scene() {
  static const BenchScene s = bench_scene(28000, 512, 384);
  return s;
}

/// Sink that counts contributions.
struct TallySink {
  static constexpr bool kTakesEmpty = false;
  std::int64_t entries = 0, pairs = 0;
  void begin(std::uint32_t) { ++entries; }
  void begin_column(int) {}
  void add(int, const Contribution<float>&) { ++pairs; }
  void end_column(int) {}
  void end() {}
};

const TallySink& tally() {
  static const TallySink total = [] {
    TallySink t;
    const BenchScene& s = scene();
    const ProjectedView<float> view = project_view({}, cloud_view(s.cloud, 0, nullptr), s.camera, SplatOptions{});
    const TileLists lists = bin_tiles({}, view, s.camera.width_px, s.camera.height_px);
    for (std::int64_t tile = 0; tile < lists.tiles(); ++tile) {
      float transmittance[kPacksPerTile<float>];
      composite_tile<float>(tile_work(view, lists, tile, s.camera, Compat::kInria), transmittance, t);
    }
    return t;
  }();
  return total;
}

void count_pairs(benchmark::State& state) {
  const TallySink& t = tally();
  state.counters["pairs/s"] = benchmark::Counter(double(t.pairs), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["pairs"] = double(t.pairs);
  state.counters["entries"] = double(t.entries);
}

/// The cloud in scalar type S, for engines outside the production path.
template <class S>
struct Columns {
  std::vector<S> position, rotation, log_scale, logit_opacity, sh_dc, sh_rest;
  const GaussianCloud& cloud;
  explicit Columns(const GaussianCloud& c)
      : position(c.position.begin(), c.position.end()),
        rotation(c.rotation.begin(), c.rotation.end()),
        log_scale(c.log_scale.begin(), c.log_scale.end()),
        logit_opacity(c.logit_opacity.begin(), c.logit_opacity.end()),
        sh_dc(c.sh_dc.begin(), c.sh_dc.end()),
        sh_rest(c.sh_rest.begin(), c.sh_rest.end()),
        cloud(c) {}
  CloudView<S> view() const {
    return {cloud.size(),         position.data(), rotation.data(), log_scale.data(),
            logit_opacity.data(), sh_dc.data(),    sh_rest.data(),  cloud.sh_degree,
            cloud.rest_count(),   nullptr,         nullptr};
  }
};

template <class S>
void forward(benchmark::State& state, TileKernels<S> kernels) {
  const BenchScene& s = scene();
  const Columns<S> columns(s.cloud);
  SplatEngine<S> engine(kernels, {}, columns.view(), s.camera, {});
  const auto pixels = std::size_t(s.camera.width_px) * std::size_t(s.camera.height_px);
  std::vector<S> colour(pixels * 3), alpha(pixels);
  const std::vector<Plane<S>> out{{&colour[0], 3}, {&colour[1], 3}, {&colour[2], 3}, {&alpha[0], 1}};
  engine.prepare({});
  for (auto unused : state) engine.composite({}, out);
  count_pairs(state);
}

template <class S>
void backward(benchmark::State& state, TileKernels<S> kernels) {
  const BenchScene& s = scene();
  const Columns<S> columns(s.cloud);
  SplatEngine<S> engine(kernels, {}, columns.view(), s.camera, {});
  const auto pixels = std::size_t(s.camera.width_px) * std::size_t(s.camera.height_px);
  std::vector<S> colour(pixels * 3, S(1e-3)), alpha(pixels);
  engine.forward({}, {{&colour[0], 3}, {&colour[1], 3}, {&colour[2], 3}, {&alpha[0], 1}});
  const std::vector<Plane<const S>> grad{{&colour[0], 3}, {&colour[1], 3}, {&colour[2], 3}, {nullptr, 1}};
  std::vector<S> position(columns.position.size()), rotation(columns.rotation.size()), scale(columns.log_scale.size()),
      opacity(columns.logit_opacity.size()), dc(columns.sh_dc.size()), rest(columns.sh_rest.size());
  const CloudGradientView<S> out{position.data(), rotation.data(), scale.data(),
                                 opacity.data(),  dc.data(),       rest.data()};
  for (auto unused : state) engine.backward({}, grad, {1, 1, 1}, out);
  count_pairs(state);
}

/// Cost per view before compositing: projection, sorting, tile lists.
void project_and_bin(benchmark::State& state) {
  const BenchScene& s = scene();
  for (auto unused : state) {
    const ProjectedView<float> view = project_view({}, cloud_view(s.cloud, 0, nullptr), s.camera, SplatOptions{});
    benchmark::DoNotOptimize(bin_tiles({}, view, s.camera.width_px, s.camera.height_px).pairs());
  }
  state.counters["Gaussians/s"] =
      benchmark::Counter(double(s.cloud.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void evidence_view(benchmark::State& state, Isa isa) {
  const BenchScene& s = scene();
  Evidence evidence(s.cloud.size(), 1);
  for (auto unused : state) add_view_evidence({.isa = isa}, s.cloud, {s.camera, s.masks}, SplatOptions{}, evidence);
  count_pairs(state);
}

void render_view(benchmark::State& state, Isa isa) {
  const BenchScene& s = scene();
  for (auto unused : state)
    benchmark::DoNotOptimize(render({.isa = isa}, s.cloud, s.camera, SplatOptions{}, {}).alpha.data[0]);
  count_pairs(state);
}

BENCHMARK(project_and_bin)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(forward, double, tile_kernels_of<double>())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(forward, v3, float_tile_kernels(Isa::kV3))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(forward, v4, float_tile_kernels(best_isa()))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(backward, double, tile_kernels_of<double>())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(backward, v3, float_tile_kernels(Isa::kV3))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(backward, v4, float_tile_kernels(best_isa()))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(evidence_view, v3, Isa::kV3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(evidence_view, v4, best_isa())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_view, v3, Isa::kV3)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_view, v4, best_isa())->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ngs::bench
