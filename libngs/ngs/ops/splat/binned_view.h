#pragma once
// One view of a cloud, projected and sorted into tiles, by the fastest way there is. Internal to ops.
#include <type_traits>

#include "ngs/ops/splat/project_block.h"
#include "ngs/ops/splat/splat_view.h"

namespace ngs {

/// `camera` relative to the cloud's origin. Where options.prepared serves the cloud, the memory is lent by it.
template <class S>
class BinnedView {
 public:
  BinnedView(const Exec& exec, const CloudView<S>& cloud, const Camera& camera, const SplatOptions& options) {
    if constexpr (std::is_same_v<S, float>)
      if (options.prepared && options.prepared->serves(cloud)) lender_ = options.prepared;
    memory_ = lent();
    if constexpr (std::is_same_v<S, float>)
      if (lender_) project_blocks(exec, *lender_, cloud, view_projector<float>(camera, options), *memory_);
    if (!lender_) memory_->view = project_view(exec, cloud, camera, options);
    TileLists& lists = memory_->lists;
    lists.tiles_x = (camera.width_px + kTilePx - 1) / kTilePx,
    lists.tiles_y = (camera.height_px + kTilePx - 1) / kTilePx;
    bin_tiles(exec, memory_->view, lists, memory_->bins);
  }
  BinnedView(BinnedView&&) noexcept = default;
  BinnedView& operator=(BinnedView&&) = delete;
  ~BinnedView() {
    if constexpr (std::is_same_v<S, float>)
      if (lender_ && memory_) lender_->memory.give_back(std::move(memory_));
  }

  const ProjectedView<S>& view() const { return memory_->view; }
  const TileLists& lists() const { return memory_->lists; }
  /// [n], of any value.
  std::vector<S>& sums(std::size_t n) {
    if (memory_->sums.size() < n) memory_->sums.resize(n);
    return memory_->sums;
  }

 private:
  std::unique_ptr<PassMemory<S>> lent() const {
    if constexpr (std::is_same_v<S, float>)
      if (lender_) return lender_->memory.take();
    return std::make_unique<PassMemory<S>>();
  }

  std::shared_ptr<const PreparedCloud> lender_;  // null: none
  std::unique_ptr<PassMemory<S>> memory_;
};

}  // namespace ngs
