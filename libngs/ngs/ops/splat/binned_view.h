#pragma once
// One view of a cloud, projected and sorted into tiles, by the fastest way there is. Internal to ops.
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "ngs/ops/splat/cull_request.h"
#include "ngs/ops/splat/prepared/project_block.h"
#include "ngs/ops/splat/splat_view.h"

namespace ngs {

/// `camera` relative to the cloud's origin. Where options.prepared serves the cloud, the memory is lent by it. Lists
/// may lack what is not asked for.
template <class S>
class BinnedView {
 public:
  BinnedView(const Exec& exec, const CloudView<S>& cloud, const Camera& camera, const SplatOptions& options,
             const CullRequest& cull = {}) {
    if constexpr (std::is_same_v<S, float>)
      if (options.prepared && options.prepared->serves(cloud)) lender_ = options.prepared;
    memory_ = lent();
    ViewProjector<S> projector = view_projector<S>(camera, options);
    TileLists& lists = memory_->lists;
    lists.tiles_x = projector.tiles_x, lists.tiles_y = projector.tiles_y;
    lists.last_z = last_needed_z(exec, cloud, projector, cull);
    if (!lists.last_z.empty()) {
      projector.drawn = box_of(lists);
      projector.far_z = just_beyond(*std::max_element(lists.last_z.begin(), lists.last_z.end()));
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
  /// TileLists::last_z. Where Gaussians say what is asked for, they are projected first.
  std::vector<double> last_needed_z(const Exec& exec, const CloudView<S>& cloud, const ViewProjector<S>& projector,
                                 const CullRequest& cull) {
    const TileLists& lists = memory_->lists;
    if (cull.max_depth != nullptr) return last_z_of(*cull.max_depth, lists);
    const std::uint8_t* const stop_after = are_few(cull.stop_after, cloud.size) ? cull.stop_after : nullptr;
    if (stop_after == nullptr && !are_few(cull.tiles_touching, cloud.size)) return {};
    CloudView<S> some = cloud;
    some.include = stop_after != nullptr ? stop_after : cull.tiles_touching;
    project(exec, some, projector);
    std::vector<double> last = last_z_of(memory_->view, lists, nullptr);
    if (stop_after == nullptr)
      for (double& z : last) z = z > 0 ? std::numeric_limits<double>::infinity() : 0;
    if (stop_after != nullptr && cull.tiles_touching != nullptr && cull.tiles_touching != stop_after) {
      const std::vector<double> reached = last_z_of(memory_->view, lists, cull.tiles_touching);
      for (std::size_t tile = 0; tile < last.size(); ++tile) last[tile] = reached[tile] > 0 ? last[tile] : 0;
    }
    return last;
  }
  /// Whether these are so few that to look for them first takes less than it leaves out: by a sample of the rows, since
  /// to count all, in every view, would take longer than that.
  static bool are_few(const std::uint8_t* flag, std::int64_t n) {
    constexpr std::int64_t kFew = 8, kSample = 1 << 12;  // of so many one
    std::int64_t found = 0, rows = 0;
    for (std::int64_t i = 0; flag != nullptr && i < n; i += n / kSample + 1) found += flag[i] != 0, ++rows;
    return kFew * found < rows;
  }
  /// The next float after z, which may be infinite.
  static float just_beyond(double z) { return std::nextafter(float(z), std::numeric_limits<float>::infinity()); }
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
