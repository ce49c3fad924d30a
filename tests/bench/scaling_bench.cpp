// Evidence of one view for varying numbers of Gaussians and pixels, to fit an exponent to the CPU times. The largest
// case needs 3 GiB.
#include <benchmark/benchmark.h>

#include "bench/bench_scene.h"
#include "ngs/ops/splat/evidence.h"

namespace ngs::bench {
namespace {

ViewMasks disc(const Camera& camera) {
  ViewMasks masks{camera.width_px, camera.height_px, {std::vector<float>()}, {}, true};
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x)
      masks.target[0].push_back(
          std::hypot(x - camera.width_px / 2, y - camera.height_px / 2) < 0.25 * camera.width_px ? 1.f : 0.f);
  return masks;
}

void one_view(benchmark::State& state, std::int64_t gaussians, const Camera& camera) {
  const GaussianCloud cloud = surface_cloud(gaussians);
  const ViewMasks masks = disc(camera);
  const SplatOptions splat = prepared_for({}, {}, cloud);  // once for all views, as in ngs-variance
  Evidence evidence(gaussians, 1);
  for (auto unused : state) add_view_evidence({}, cloud, {camera, masks}, splat, evidence);
}

void gaussians(benchmark::State& state) { one_view(state, state.range(0), bench_camera(1152, 864)); }

void pixels(benchmark::State& state) {
  const int width = int(state.range(0));
  one_view(state, 200000, bench_camera(width, width * 3 / 4));
}

BENCHMARK(gaussians)->Arg(100000)->Arg(1000000)->Arg(10000000)->Unit(benchmark::kMillisecond);
BENCHMARK(pixels)->Arg(516)->Arg(1032)->Arg(2064)->Arg(3264)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace ngs::bench
