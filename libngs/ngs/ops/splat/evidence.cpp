#include "ngs/ops/splat/evidence.h"

#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/splat/binned_view.h"
#include "ngs/ops/splat/cloud_view.h"
#include "ngs/ops/splat/splat_view.h"
#include "ngs/ops/splat/tile_isa.h"
#include "ngs/ops/splat/tile_scratch.h"

namespace ngs {
namespace {

/// The pairs of one view with what each draws, [pairs, 2 + 2K].
class ViewPairs {
 public:
  ViewPairs(const Exec& exec, const GaussianCloud& cloud, const MaskedView& of, const SplatOptions& options)
      : binned_(exec, cloud_view(cloud, 0, nullptr), relative_camera(of.camera, cloud), options),
        columns_(2 + 2 * of.masks.target.size()) {
    const ViewMasks& masks = of.masks;
    const int objects = int(masks.target.size());
    std::vector<float>& sums = binned_.sums(std::size_t(binned_.lists().pairs()) * columns_);
    const TileKernels<float> kernels = float_tile_kernels(exec.isa);
    std::vector<const float*> target;
    for (const std::vector<float>& t : masks.target) target.push_back(t.data());
    for_each_task(exec, binned_.lists().tiles(), [&](std::int64_t tile) {
      static thread_local TileScratch<float> scratch;
      kernels.evidence({tile_work(binned_.view(), binned_.lists(), tile, of.camera, options.compat),
                        masks.known.empty() ? nullptr : masks.known.data(), target.data(), objects, sums.data(),
                        scratch.values(evidence_scratch(objects))});
    });
    sums_ = sums.data();
  }

  std::int64_t chunks() const { return (std::int64_t(binned_.view().id.size()) + kChunk - 1) / kChunk; }
  /// f(Gaussian, its sums) for the Gaussians of a chunk with W > 0, of those `of` them (null: all), in their order.
  template <class F>
  void for_each_seen(std::int64_t chunk, const std::vector<std::uint8_t>* of, const F& f) const {
    const std::vector<std::uint32_t>& id = binned_.view().id;
    std::vector<double> sum(columns_);
    const auto end = std::min(id.size(), std::size_t((chunk + 1) * kChunk));
    for (auto v = std::size_t(chunk * kChunk); v < end; ++v) {
      if (of != nullptr && !(*of)[id[v]]) continue;
      sum_up(v, sum.data());
      if (sum[0] > 0) f(id[v], sum.data());
    }
  }

 private:
  static constexpr std::int64_t kChunk = 1 << 12;

  /// The sums of visible Gaussian v over its tiles.
  void sum_up(std::size_t v, double* sum) const {
    const TileLists& lists = binned_.lists();
    std::fill_n(sum, columns_, 0.0);
    for (std::int64_t slot = lists.slot_begin[v]; slot < lists.slot_begin[v + 1]; ++slot)
      for (std::size_t c = 0; c < columns_; ++c) sum[c] += double(sums_[std::size_t(slot) * columns_ + c]);
    for (std::size_t c = 2; c < columns_; c += 2) sum[c] = std::min(sum[c], sum[0]);
  }

  BinnedView<float> binned_;
  std::size_t columns_;
  const float* sums_ = nullptr;
};

/// [N, 2 + 2K] from the device, the same.
std::vector<double> sums_on_device(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                                   const SplatOptions& options) {
  const ViewProjector<float> projector = view_projector<float>(relative_camera(view.camera, cloud), options);
  std::vector<double> sums = exec.device_ops->splat.evidence(projector, cloud_view(cloud, 0, nullptr), view.masks);
  const std::size_t columns = 2 + 2 * view.masks.target.size();
  for (std::size_t row = 0; row < sums.size(); row += columns)
    for (std::size_t c = 2; c < columns; c += 2) sums[row + c] = std::min(sums[row + c], sums[row]);
  return sums;
}

void require_size(const MaskedView& view) {
  NGS_CHECK(view.masks.width_px == view.camera.width_px && view.masks.height_px == view.camera.height_px, "mask size");
}

}  // namespace

ViewSums view_sums(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view, const SplatOptions& options,
                   const std::vector<std::uint8_t>* of) {
  ViewSums seen{int(view.masks.target.size()), {}, {}};
  if (!view.masks.available) return seen;
  require_size(view);
  NGS_CHECK(of == nullptr || std::int64_t(of->size()) == cloud.size(), "one flag per Gaussian");
  const auto columns = std::size_t(seen.columns());
  if (exec.device_ops) {
    const std::vector<double> sums = sums_on_device(exec, cloud, view, options);
    for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
      const double* sum = &sums[i * columns];
      const bool wanted = of == nullptr || (*of)[i];
      if (wanted && sum[0] > 0)
        seen.row.push_back(std::uint32_t(i)), seen.sum.insert(seen.sum.end(), sum, sum + columns);
    }
    return seen;
  }
  const ViewPairs pairs(exec, cloud, view, options);
  std::vector<ViewSums> part(std::size_t(pairs.chunks()), ViewSums{seen.objects, {}, {}});
  for_each_task(exec, pairs.chunks(), [&](std::int64_t chunk) {
    pairs.for_each_seen(chunk, of,
                        [&part = part[std::size_t(chunk)], columns](std::uint32_t gaussian, const double* sum) {
                          part.row.push_back(gaussian), part.sum.insert(part.sum.end(), sum, sum + columns);
                        });
  });
  for (const ViewSums& p : part)
    seen.row.insert(seen.row.end(), p.row.begin(), p.row.end()),
        seen.sum.insert(seen.sum.end(), p.sum.begin(), p.sum.end());
  return seen;
}

void add_view_evidence(const Exec& exec, const GaussianCloud& cloud, const MaskedView& view,
                       const SplatOptions& options, Evidence& evidence) {
  const ViewMasks& masks = view.masks;
  if (!masks.available) return;
  require_size(view);
  NGS_CHECK(int(masks.target.size()) == evidence.objects && evidence.gaussians == cloud.size(), "evidence shape");
  const std::size_t columns = 2 + 2 * masks.target.size();
  if (exec.device_ops) {
    const std::vector<double> sums = sums_on_device(exec, cloud, view, options);
    return for_each_index(exec, cloud.size(), [&](std::int64_t i) {
      const double* sum = &sums[std::size_t(i) * columns];
      if (sum[0] > 0) evidence.add(std::size_t(i), sum);
    });
  }
  const ViewPairs pairs(exec, cloud, view, options);
  for_each_task(exec, pairs.chunks(), [&](std::int64_t chunk) {
    pairs.for_each_seen(chunk, nullptr,
                        [&](std::uint32_t gaussian, const double* sum) { evidence.add(gaussian, sum); });
  });
}

}  // namespace ngs
