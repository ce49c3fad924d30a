#include "ngs/ops/evidence.h"

#include "ngs/core/check.h"
#include "ngs/ops/cloud_view.h"
#include "ngs/ops/device_ops.h"
#include "ngs/ops/tile_isa.h"
#include "ngs/ops/tile_scratch.h"

namespace ngs {
namespace {

/// The rows of [n, columns] sums with a weight, as those of Gaussians id(row).
template <class Id>
ViewSums seen_rows(const std::vector<double>& sums, int objects, const Id& id) {
  ViewSums seen;
  seen.objects = objects;
  const auto columns = std::size_t(seen.columns());
  for (std::size_t row = 0; row * columns < sums.size(); ++row) {
    const double* sum = &sums[row * columns];
    if (!(sum[0] > 0)) continue;
    seen.row.push_back(id(row));
    seen.sum.insert(seen.sum.end(), sum, sum + columns);
    double* own = &seen.sum[seen.sum.size() - columns];
    for (int k = 0; k < objects; ++k) own[2 + 2 * k] = std::min(own[2 + 2 * k], own[0]);
  }
  return seen;
}

}  // namespace

ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& options,
                   const ViewMasks& masks) {
  const int objects = int(masks.target.size()), columns = 2 + 2 * objects;
  if (!masks.available) return {objects, {}, {}};
  NGS_CHECK(masks.width_px == camera.width_px && masks.height_px == camera.height_px, "mask size");
  const Camera relative = relative_camera(camera, cloud);
  if (exec.device_ops)
    return seen_rows(exec.device_ops->splat.evidence(relative, options, cloud_view(cloud, 0, nullptr), masks), objects,
                     [](std::size_t row) { return std::uint32_t(row); });
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
                      masks.known.empty() ? nullptr : masks.known.data(), target.data(), objects, pair_sums.data(),
                      scratch.values(evidence_scratch(objects))});
  });
  std::vector<double> sums(view.id.size() * std::size_t(columns));
  for_each_index(exec, std::int64_t(view.id.size()), [&](std::int64_t v) {
    double* sum = &sums[std::size_t(v * columns)];
    for (std::int64_t slot = lists.slot_begin[std::size_t(v)]; slot < lists.slot_begin[std::size_t(v) + 1]; ++slot)
      for (int c = 0; c < columns; ++c) sum[c] += double(pair.row(slot)[c]);
  });
  return seen_rows(sums, objects, [&](std::size_t v) { return view.id[v]; });
}

void add_sums(const Exec& exec, const ViewSums& sums, Evidence& evidence) {
  NGS_CHECK(sums.objects == evidence.objects, "evidence of other objects");
  for_each_index(exec, std::int64_t(sums.size()), [&](std::int64_t v) { evidence.add(sums, std::size_t(v)); });
}

void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                       const SplatOptions& options, const ViewMasks& masks, Evidence& evidence) {
  if (!masks.available) return;
  NGS_CHECK(int(masks.target.size()) == evidence.objects && evidence.gaussians == cloud.size(), "evidence shape");
  add_sums(exec, view_sums(exec, cloud, camera, options, masks), evidence);
}

}  // namespace ngs
