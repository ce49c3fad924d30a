#include "ngs/ops/evidence.h"

#include "ngs/core/check.h"
#include "ngs/ops/cloud_view.h"
#include "ngs/ops/device_ops.h"
#include "ngs/ops/tile_isa.h"
#include "ngs/ops/tile_scratch.h"

namespace ngs {
namespace {

std::uint64_t quantised(double unit) { return std::uint64_t(std::llround(unit * 0x1p32)); }

/// Folds a Gaussian's sums over one view into its row of the evidence.
void fold_gaussian(const double* sum, std::size_t gaussian, Evidence& e) {
  const double weight = sum[0], pixels = sum[1];
  if (!(weight > 0)) return;
  e.weight.add(gaussian, weight);
  e.pixels[gaussian] += std::uint64_t(pixels);
  e.views[gaussian] += 1;
  for (int k = 0; k < e.objects; ++k) {
    const std::size_t cell = gaussian * std::size_t(e.objects) + std::size_t(k);
    const double object_weight = std::min(sum[2 + 2 * k], weight), object_pixels = sum[3 + 2 * k];
    e.object_weight.add(cell, object_weight);
    e.object_pixels[cell] += std::uint64_t(object_pixels);
    e.add_signal(cell, object_weight / weight);
    e.contrast_sum[cell] += quantised(std::abs(2 * object_pixels - pixels) / pixels);
  }
}

}  // namespace

void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                       const SplatOptions& options, const ViewMasks& masks, Evidence& evidence) {
  if (!masks.available) return;
  NGS_CHECK(masks.width_px == camera.width_px && masks.height_px == camera.height_px, "mask size");
  NGS_CHECK(int(masks.target.size()) == evidence.objects && evidence.gaussians == cloud.size(), "evidence shape");
  const Camera relative = relative_camera(camera, cloud);
  const int columns = 2 + 2 * evidence.objects;
  if (exec.device_ops) {
    const std::vector<double> sums = exec.device_ops->splat.evidence(relative, options, cloud_view(cloud, 0, nullptr), masks);
    return for_each_index(exec, cloud.size(), [&](std::int64_t i) {
      fold_gaussian(&sums[std::size_t(i * columns)], std::size_t(i), evidence);
    });
  }
  const ProjectedView<float> view = project_view(exec, cloud_view(cloud, 0, nullptr), relative, options);
  const TileLists lists = bin_tiles(exec, view, camera.width_px, camera.height_px);
  std::vector<float> pair_sums(std::size_t(lists.pairs()) * std::size_t(columns), 0.f);
  const Matrix<float> pair{pair_sums.data(), lists.pairs(), columns};
  const TileKernels<float> kernels = float_tile_kernels(exec.isa);
  std::vector<const float*> target;
  for (const std::vector<float>& t : masks.target) target.push_back(t.data());
  for_each_task(exec, lists.tiles(), [&](std::int64_t tile) {
    static thread_local TileScratch<float> scratch;
    kernels.evidence({tile_work(view, lists, tile, camera, options.compat),
                      masks.known.empty() ? nullptr : masks.known.data(), target.data(), evidence.objects,
                      pair_sums.data(), scratch.values(evidence_scratch(evidence.objects))});
  });
  for_each_index(exec, std::int64_t(view.id.size()), [&](std::int64_t v) {
    std::vector<double> sum(std::size_t(columns), 0.0);
    for (std::int64_t slot = lists.slot_begin[std::size_t(v)]; slot < lists.slot_begin[std::size_t(v) + 1]; ++slot)
      for (int c = 0; c < columns; ++c) sum[std::size_t(c)] += double(pair.row(slot)[c]);
    fold_gaussian(sum.data(), view.id[std::size_t(v)], evidence);
  });
}

}  // namespace ngs
