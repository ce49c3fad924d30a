#pragma once
// Label blocks from recorded tiles, and smaller ones from these. Internal to ops (label_system.cpp).
#include "ngs/ops/labels/label_block.h"

namespace ngs {

/// Where a Gaussian's label is, for collect_block: its column, or -1 and the folded value.
struct LabelPlaces {
  const std::uint32_t* id;     // [V] Gaussians that the view shows
  const std::int32_t* column;  // [N]
  const double* label;         // [N]
};

/// The tile's block, in half precision if wanted; slots are those of the view's lists.
LabelBlock collect_block(const RecordedTile& tile, LabelPlaces places, TargetPlanes targets, bool half);

/// The block with only the columns whose `new_column` is >= 0, renumbered; the others are folded at their
/// values. Its constant_loss is that of the pixels which no column reaches any more; its target_sum is 0.
LabelBlock reduced_block(const LabelBlock& block, const std::int32_t* new_column, ColumnValues at);

}  // namespace ngs
