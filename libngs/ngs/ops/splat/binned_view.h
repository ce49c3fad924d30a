#pragma once
// One view of a cloud, projected and sorted into tiles, by the fastest way there is. Internal to ops.
#include <algorithm>
#include <type_traits>

#include "ngs/ops/splat/project_block.h"
#include "ngs/ops/splat/splat_view.h"

namespace ngs {

/// `camera` relative to the cloud's origin. Where options.prepared serves the cloud, the memory is lent by it. Where
/// the cloud has `where`, tiles that none of these Gaussians reaches may have empty lists.
template <class S>
class BinnedView {
 public:
  BinnedView(const Exec& exec, const CloudView<S>& cloud, const Camera& camera, const SplatOptions& options) {
    if constexpr (std::is_same_v<S, float>)
      if (options.prepared && options.prepared->serves(cloud)) lender_ = options.prepared;
    memory_ = lent();
    ViewProjector<S> projector = view_projector<S>(camera, options);
    TileLists& lists = memory_->lists;
    lists.tiles_x = projector.tiles_x, lists.tiles_y = projector.tiles_y;
    lists.drawn.clear();
    if (cloud.where != nullptr && are_few(cloud)) {
      CloudView<S> some = cloud;
      some.include = cloud.where, some.far_z = CloudView<S>::kEverything;
      project(exec, some, projector);
      lists.drawn = spans_reached(memory_->view, lists.tiles_y);
      projector.drawn = box_of(lists.drawn);
    }
    project(exec, cloud, projector);
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
  /// Whether what is asked of is so little that to find its tiles first takes less than it leaves out.
  static bool are_few(const CloudView<S>& cloud) {
    constexpr std::int64_t kFew = 8;  // of so many one
    return kFew * std::count_if(cloud.where, cloud.where + cloud.size, [](auto flag) { return flag != 0; }) <
           cloud.size;
  }
  void project(const Exec& exec, const CloudView<S>& cloud, const ViewProjector<S>& projector) {
    if constexpr (std::is_same_v<S, float>)
      if (lender_) return project_blocks(exec, *lender_, cloud, projector, *memory_);
    memory_->view = project_view(exec, cloud, projector);
  }
  std::unique_ptr<PassMemory<S>> lent() const {
    if constexpr (std::is_same_v<S, float>)
      if (lender_) return lender_->memory.take();
    return std::make_unique<PassMemory<S>>();
  }

  std::shared_ptr<const PreparedCloud> lender_;  // null: none
  std::unique_ptr<PassMemory<S>> memory_;
};

}  // namespace ngs
