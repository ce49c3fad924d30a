#include "ngs/ops/splat/evidence.h"

#include "ngs/core/check.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_view.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/tile_scratch.h"

namespace ngs {
namespace {

/// The pairs of one view with what each draws, [pairs, 2 + 2K].
struct ViewPairs {
  std::vector<std::uint32_t> id;  // [V]
  TileLists lists;
  std::vector<float> sums;
  std::size_t columns;

  /// The sums of visible Gaussian v over its tiles.
  void sum_up(std::size_t v, double* sum) const {
    std::fill_n(sum, columns, 0.0);
    for (std::int64_t slot = lists.slot_begin[v]; slot < lists.slot_begin[v + 1]; ++slot)
      for (std::size_t c = 0; c < columns; ++c) sum[c] += double(sums[std::size_t(slot) * columns + c]);
    for (std::size_t c = 2; c < columns; c += 2) sum[c] = std::min(sum[c], sum[0]);
  }
};

ViewPairs pairs_of(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                   const ViewMasks& masks) {
  const int objects = int(masks.target.size());
  ProjectedView<float> view = project_view(exec, cloud_view(cloud, 0, nullptr), relative_camera(camera, cloud), options);
  ViewPairs pairs{{}, bin_tiles(exec, view, camera.width_px, camera.height_px), {}, std::size_t(2 + 2 * objects)};
  pairs.sums.assign(std::size_t(pairs.lists.pairs()) * pairs.columns, 0.f);
  const TileKernels<float> kernels = float_tile_kernels(exec.isa);
  std::vector<const float*> target;
  for (const std::vector<float>& t : masks.target) target.push_back(t.data());
  for_each_task(exec, pairs.lists.tiles(), [&](std::int64_t tile) {
    static thread_local TileScratch<float> scratch;
    kernels.evidence({tile_work(view, pairs.lists, tile, camera, options.compat),
                      masks.known.empty() ? nullptr : masks.known.data(), target.data(), objects, pairs.sums.data(),
                      scratch.values(evidence_scratch(objects))});
  });
  pairs.id = std::move(view.id);
  return pairs;
}

/// [N, 2 + 2K] from the device, the same.
std::vector<double> sums_on_device(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                                   const SplatOptions& options, const ViewMasks& masks) {
  std::vector<double> sums =
      exec.device_ops->splat.evidence(relative_camera(camera, cloud), options, cloud_view(cloud, 0, nullptr), masks);
  const std::size_t columns = 2 + 2 * masks.target.size();
  for (std::size_t row = 0; row < sums.size(); row += columns)
    for (std::size_t c = 2; c < columns; c += 2) sums[row + c] = std::min(sums[row + c], sums[row]);
  return sums;
}

void require_size(const ViewMasks& masks, const Camera& camera) {
  NGS_CHECK(masks.width_px == camera.width_px && masks.height_px == camera.height_px, "mask size");
}

}  // namespace

ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                   const ViewMasks& masks, const std::vector<std::uint8_t>* of) {
  ViewSums seen{int(masks.target.size()), {}, {}};
  if (!masks.available) return seen;
  require_size(masks, camera);
  NGS_CHECK(of == nullptr || std::int64_t(of->size()) == cloud.size(), "one flag per Gaussian");
  const auto columns = std::size_t(seen.columns());
  const auto take = [&](std::uint32_t gaussian, const double* sum) {
    const bool wanted = of == nullptr || (*of)[gaussian];
    if (wanted && sum[0] > 0) seen.row.push_back(gaussian), seen.sum.insert(seen.sum.end(), sum, sum + columns);
  };
  if (exec.device_ops) {
    const std::vector<double> sums = sums_on_device(exec, cloud, camera, options, masks);
    for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) take(std::uint32_t(i), &sums[i * columns]);
    return seen;
  }
  const ViewPairs pairs = pairs_of(exec, cloud, camera, options, masks);
  std::vector<double> sums(pairs.id.size() * columns);
  for_each_index(exec, std::int64_t(pairs.id.size()), [&](std::int64_t v) {
    if (of == nullptr || (*of)[pairs.id[std::size_t(v)]]) pairs.sum_up(std::size_t(v), &sums[std::size_t(v) * columns]);
  });
  for (std::size_t v = 0; v < pairs.id.size(); ++v) take(pairs.id[v], &sums[v * columns]);
  return seen;
}

void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                       const SplatOptions& options, const ViewMasks& masks, Evidence& evidence) {
  if (!masks.available) return;
  require_size(masks, camera);
  NGS_CHECK(int(masks.target.size()) == evidence.objects && evidence.gaussians == cloud.size(), "evidence shape");
  const std::size_t columns = 2 + 2 * masks.target.size();
  if (exec.device_ops) {
    const std::vector<double> sums = sums_on_device(exec, cloud, camera, options, masks);
    return for_each_index(exec, cloud.size(), [&](std::int64_t i) {
      const double* sum = &sums[std::size_t(i) * columns];
      if (sum[0] > 0) evidence.add(std::size_t(i), sum);
    });
  }
  const ViewPairs pairs = pairs_of(exec, cloud, camera, options, masks);
  for_each_index(exec, std::int64_t(pairs.id.size()), [&](std::int64_t v) {
    std::vector<double> sum(columns);
    pairs.sum_up(std::size_t(v), sum.data());
    if (sum[0] > 0) evidence.add(pairs.id[std::size_t(v)], sum.data());
  });
}

}  // namespace ngs
