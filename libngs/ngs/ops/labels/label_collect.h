#pragma once
// Builds label blocks from recorded tiles, and reduced blocks from label blocks. Internal to ops (label_system.cpp).
#include "ngs/ops/labels/label_block.h"

namespace ngs {

/// The labels of the Gaussians for collect_block: the column, or -1 and the folded value.
struct LabelPlaces {
  const std::uint32_t* id;     // [V] visible Gaussians
  const std::int32_t* column;  // [N]
  const double* label;         // [N]
};

/// The block of a tile, with weights in half precision if `half`; slots are those of the view's lists.
LabelBlock collect_block(const RecordedTile& tile, LabelPlaces places, TargetPlanes targets, bool half);

/// The block with only the columns whose `new_column` is >= 0, renumbered; the others are folded at their values. Its
/// constant_loss is that of the pixels that lose their last column; its target_sum is 0.
LabelBlock reduced_block(const LabelBlock& block, const std::int32_t* new_column, ColumnValues at);

}  // namespace ngs
