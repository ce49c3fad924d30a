#pragma once
// One view of a cloud, projected and binned into tiles, with culling and with the prepared cloud if there is one.
// Internal to ops.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "ngs/ops/splat/prepared/project_block.h"
#include "ngs/ops/splat/splat_view.h"
#include "ngs/scene/views.h"

namespace ngs {

// Which Gaussians and tiles of a view are needed, so that the others are neither projected nor rasterised. Internal to
// ops. Pixels of skipped tiles are undefined, and so is a Gaussian's contribution behind `stop_after` or `max_depth`:
// the caller must not read them.
struct CullRequest {
  /// [N] Render only tiles that a flagged Gaussian touches; null: all tiles.
  const std::uint8_t* tiles_touching = nullptr;
  /// [N] Per tile, skip everything behind the last flagged Gaussian; null: nothing.
  const std::uint8_t* stop_after = nullptr;
  /// [H, W, 1] Skip Gaussians at this depth or farther, all where it is 0; null: none.
  const ImageF* max_depth = nullptr;
  /// [tiles] 0: do not render the tile; null: all tiles. Not combined with the others.
  const std::uint8_t* tiles = nullptr;
};

/// `camera` is relative to the cloud's origin. If options.prepared was made from `cloud`, the memory comes from its
/// pool. The tile lists leave out what `cull` makes unnecessary.
template <class S>
class BinnedView {
 public:
  BinnedView(const Exec& exec, const CloudView<S>& cloud, const Camera& camera, const SplatOptions& options,
             const CullRequest& cull = {}) {
    if constexpr (std::is_same_v<S, float>)
      if (options.prepared && options.prepared->serves(cloud)) prepared_ = options.prepared;
    memory_ = acquire_memory();
    ViewProjector<S> projector = view_projector<S>(camera, options);
    TileLists& lists = memory_->lists;
    lists.tiles_x = projector.tiles_x;
    lists.tiles_y = projector.tiles_y;
    lists.last_z = last_needed_z(exec, cloud, projector, cull);
    if (!lists.last_z.empty()) {
      projector.drawn = bounding_rect(lists);
      projector.far_z = next_float(*std::max_element(lists.last_z.begin(), lists.last_z.end()));
    }
    project(exec, cloud, projector);
    bin_tiles(exec, memory_->view, lists, memory_->bins);
  }
  BinnedView(BinnedView&&) noexcept = default;
  BinnedView& operator=(BinnedView&&) = delete;
  ~BinnedView() {
    if constexpr (std::is_same_v<S, float>)
      if (prepared_ && memory_) prepared_->memory.release(std::move(memory_));
  }

  const ProjectedView<S>& view() const { return memory_->view; }
  const TileLists& lists() const { return memory_->lists; }
  /// [n] scratch; the values are undefined.
  std::vector<S>& sums(std::size_t n) {
    if (memory_->sums.size() < n) memory_->sums.resize(n);
    return memory_->sums;
  }

 private:
  /// TileLists::last_z. If the request consists of Gaussians, these are projected first to find it.
  std::vector<double> last_needed_z(const Exec& exec, const CloudView<S>& cloud, const ViewProjector<S>& projector,
                                    const CullRequest& cull) {
    const TileLists& lists = memory_->lists;
    if (cull.max_depth != nullptr) return last_z_of(*cull.max_depth, lists);
    if (cull.tiles != nullptr) {
      std::vector<double> needed(std::size_t(lists.tiles()), 0.0);
      for (std::size_t tile = 0; tile < needed.size(); ++tile)
        if (cull.tiles[tile]) needed[tile] = std::numeric_limits<double>::infinity();
      return needed;
    }
    const std::uint8_t* const stop_after = is_sparse(cull.stop_after, cloud.size) ? cull.stop_after : nullptr;
    if (stop_after == nullptr && !is_sparse(cull.tiles_touching, cloud.size)) return {};
    CloudView<S> requested = cloud;
    requested.include = stop_after != nullptr ? stop_after : cull.tiles_touching;
    project(exec, requested, projector);
    std::vector<double> last = last_z_of(memory_->view, lists, nullptr);
    if (stop_after == nullptr)
      for (double& z : last) z = z > 0 ? std::numeric_limits<double>::infinity() : 0;
    if (stop_after != nullptr && cull.tiles_touching != nullptr && cull.tiles_touching != stop_after) {
      const std::vector<double> reached = last_z_of(memory_->view, lists, cull.tiles_touching);
      for (std::size_t tile = 0; tile < last.size(); ++tile) last[tile] = reached[tile] > 0 ? last[tile] : 0;
    }
    return last;
  }
  /// Whether so few rows are flagged that projecting them first costs less than culling saves. Decided from a sample of
  /// the rows: counting all of them in every view would cost more than it saves.
  static bool is_sparse(const std::uint8_t* flag, std::int64_t n) {
    constexpr std::int64_t kFew = 8, kSample = 1 << 12;  // sparse: fewer than one row in kFew
    std::int64_t found = 0, rows = 0;
    for (std::int64_t i = 0; flag != nullptr && i < n; i += n / kSample + 1) {
      found += flag[i] != 0;
      ++rows;
    }
    return kFew * found < rows;
  }
  /// The next float after z, which may be infinite.
  static float next_float(double z) { return std::nextafter(float(z), std::numeric_limits<float>::infinity()); }
  void project(const Exec& exec, const CloudView<S>& cloud, const ViewProjector<S>& projector) {
    if constexpr (std::is_same_v<S, float>)
      if (prepared_) return project_blocks(exec, *prepared_, cloud, projector, *memory_);
    memory_->view = project_view(exec, cloud, projector);
  }
  std::unique_ptr<ViewScratch<S>> acquire_memory() const {
    if constexpr (std::is_same_v<S, float>)
      if (prepared_) return prepared_->memory.acquire();
    return std::make_unique<ViewScratch<S>>();
  }

  std::shared_ptr<const PreparedCloud> prepared_;  // null: the cloud is not prepared
  std::unique_ptr<ViewScratch<S>> memory_;
};

}  // namespace ngs
