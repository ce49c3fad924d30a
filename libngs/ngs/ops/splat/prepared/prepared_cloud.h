#pragma once
// The view-independent part of projection, computed once for all views of a fixed model; for a device, the model's
// columns in its memory.
// Internal to ops, except `prepare_cloud`.
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "ngs/core/raw_column.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/ops/splat/tile_lists.h"

namespace ngs {

/// Scratch memory for rendering one view, reused for the next: fresh pages cost as much to fault in as the data to
/// write.
template <class S>
struct ViewScratch {
  ProjectedView<S> view;
  TileLists lists;
  BinScratch bins;
  std::vector<std::uint8_t> reaches;  // [rows] 1: the Gaussian may reach a pixel
  std::vector<std::int64_t> first;    // [blocks + 1] first row of ProjectedView per block
  std::vector<S> sums;                // per-pair sums of the pass
};

/// Pool of ViewScratch. Holds as many as were ever in use at once. Thread-safe.
class ViewScratchPool {
 public:
  std::unique_ptr<ViewScratch<float>> acquire() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<ViewScratch<float>>();
    std::unique_ptr<ViewScratch<float>> memory = std::move(free_.back());
    free_.pop_back();
    return memory;
  }
  void release(std::unique_ptr<ViewScratch<float>> memory) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(memory));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<ViewScratch<float>>> free_;
};

class DeviceCloud;
struct CloudOnHost;

inline constexpr int kBlockRows = 256;
inline constexpr int kGroupBlocks = 16;

/// Bounding box of the centres of a block, or of a group of blocks, and a bound of its largest scale. Rows that are
/// never drawn do not count.
struct BlockBounds {
  static constexpr float kNone = std::numeric_limits<float>::infinity();
  std::array<float, 3> lo{kNone, kNone, kNone}, hi{-kNone, -kNone, -kNone};  // world, relative to the cloud's origin
  float scale = 0;                                                           // at least the largest scale, world
  bool empty() const { return lo[0] > hi[0]; }
  void cover(const BlockBounds& other);
};

/// Columns of N rows in the order of a space-filling curve, so that each block lies in a small box. Padded to a
/// multiple of kBlockRows with rows that are never drawn.
///
/// Keeps pointers into the source cloud: valid while the columns stay in place and update() is called for changed rows.
/// With a device, only on_device() is filled.
class PreparedCloud {
 public:
  PreparedCloud(const Exec& exec, const CloudView<float>& cloud);
  ~PreparedCloud();
  PreparedCloud(const PreparedCloud&) = delete;
  PreparedCloud& operator=(const PreparedCloud&) = delete;

  /// Whether it was made from these columns, by address, and for the CPU.
  bool serves(const CloudView<float>& cloud) const;
  /// The columns in device memory if it was made from these columns and for a device; else null.
  DeviceCloud* on_device(const CloudView<float>& cloud) const;
  /// Call after these rows of the cloud have changed; each row once.
  void update(const Exec& exec, const std::vector<std::int64_t>& rows);
  std::int64_t blocks() const { return std::int64_t(bounds.size()); }
  std::int64_t groups() const { return std::int64_t(group_bounds.size()); }

  RawColumn<std::uint32_t> row;                     // [N] row of the cloud
  std::array<RawColumn<float>, 3> position;         // world, relative to the cloud's origin
  std::array<RawColumn<float>, 9> shape;            // rotation · diag(scale), row-major            world
  RawColumn<float> opacity;                         // sigmoid of the logit; 0 where the row is not usable
  RawColumn<float> max_mahalanobis2, log2_opacity;  // as in SplatRecord, without the compensation of antialiasing
  RawColumn<float> scale_bound;                     // at least the largest scale                   world
  std::vector<BlockBounds> bounds;                  // [blocks]
  std::vector<BlockBounds> group_bounds;            // [groups] of kGroupBlocks consecutive blocks
  mutable ViewScratchPool memory;                   // scratch that is reused from view to view

 private:
  bool is_from(const CloudView<float>& cloud) const;
  /// Fills a place from row[place] of the cloud.
  void prepare_place(std::size_t place);
  /// Makes a place a row that is never drawn.
  void clear_place(std::size_t place);
  BlockBounds bounds_of(std::int64_t block) const;
  /// Computes group_bounds from bounds.
  void bound_groups();

  CloudView<float> source_;
  std::unique_ptr<DeviceCloud> on_device_;
  std::vector<std::uint32_t> place_of_;  // [N] place of each row; empty before the first update
};

/// A cloud as the argument of a device's op: with its resident columns if `options` has them.
CloudOnHost on_host(const CloudView<float>& cloud, const SplatOptions& options);

}  // namespace ngs
