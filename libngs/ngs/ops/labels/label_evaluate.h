#pragma once
// Losses of labels and the sums that their gradients are made of, tile by tile. Internal to ops (label_system.cpp).
#include "ngs/ops/labels/label_block.h"

namespace ngs {

/// The block's part of Σ a ln q + b ln c, negated; writes its entries' slots.
double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots);

/// Loss and targets of a tile.
struct TileLoss {
  double loss = 0;        // -Σ a ln q + b ln c
  double target_sum = 0;  // Σ a + b
};

/// The sums of all Gaussians of the tile, which stand at `at` [V]; writes their slots. The same sums as those of a
/// block whose columns are all Gaussians.
TileLoss evaluate_tile(const RecordedTile& tile, ColumnValues at, TargetPlanes targets, SlotSums* slots);

}  // namespace ngs
