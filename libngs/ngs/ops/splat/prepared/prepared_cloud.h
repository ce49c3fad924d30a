#pragma once
// What projection takes from a Gaussian alone, worked out once for all views of a model that does not change.
// Internal to ops, but for `prepare_cloud`.
#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "ngs/core/raw_column.h"
#include "ngs/ops/splat/prepared/pass_memory.h"
#include "ngs/ops/splat/splat_gaussian.h"

namespace ngs {

inline constexpr int kBlockRows = 256;
inline constexpr int kGroupBlocks = 16;

/// The box of the centres of a block, or of a group of blocks, and its largest Gaussian. Rows that no view draws are
/// not counted.
struct BlockBounds {
  static constexpr float kNone = std::numeric_limits<float>::infinity();
  std::array<float, 3> lo{kNone, kNone, kNone}, hi{-kNone, -kNone, -kNone};  // world, relative to the cloud's origin
  float scale = 0;                                                           // at least the largest
  bool empty() const { return lo[0] > hi[0]; }
  void cover(const BlockBounds& other);
};

/// Columns of N rows along a space-filling curve, so that each block lies in a small box, filled up with rows that are
/// never drawn to a multiple of kBlockRows.
///
/// Holds what it was made from by address: it serves that cloud as long as none of its columns moves, and rows that
/// change are told.
class PreparedCloud {
 public:
  PreparedCloud(const Exec& exec, const CloudView<float>& cloud);
  PreparedCloud(const PreparedCloud&) = delete;
  PreparedCloud& operator=(const PreparedCloud&) = delete;

  /// Whether it was made from these columns.
  bool serves(const CloudView<float>& cloud) const;
  /// After these rows of the cloud have changed, each named once.
  void update(const Exec& exec, const std::vector<std::int64_t>& rows);
  std::int64_t blocks() const { return std::int64_t(bounds.size()); }
  std::int64_t groups() const { return std::int64_t(group_bounds.size()); }

  RawColumn<std::uint32_t> row;              // [N] of the cloud
  std::array<RawColumn<float>, 3> position;  // world, relative to the cloud's origin
  std::array<RawColumn<float>, 9> shape;     // rotation · diag(scale), row-major            world
  RawColumn<float> opacity;                  // sigmoid of the logit; 0 where the row is not usable
  RawColumn<float> max_mahalanobis2, log2_opacity;    // as in SplatRecord, without the compensation of antialiasing
  RawColumn<float> scale_bound;              // at least the largest scale                   world
  std::vector<BlockBounds> bounds;           // [blocks]
  std::vector<BlockBounds> group_bounds;     // [groups] of kGroupBlocks blocks that follow each other
  mutable PassMemoryPool memory;             // what passes over this cloud keep from view to view

 private:
  /// From row[place] of the cloud.
  void prepare_place(std::size_t place);
  /// A row that no view draws.
  void clear_place(std::size_t place);
  BlockBounds bounds_of(std::int64_t block) const;
  /// group_bounds of the bounds.
  void bound_groups();

  CloudView<float> source_;
  std::vector<std::uint32_t> place_of_;  // [N] a row's place; none before the first update
};

}  // namespace ngs
