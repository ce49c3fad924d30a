#pragma once
// Losses of labels and the sums of their gradients, tile by tile. Internal to ops (label_system.cpp).
#include "ngs/ops/labels/label_block.h"

namespace ngs {

/// The block's part of -(Σ a ln q + b ln c). Writes the slots of its entries.
double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots);

/// Loss and targets of a tile.
struct TileLoss {
  double loss = 0;        // -Σ a ln q + b ln c
  double target_sum = 0;  // Σ a + b
};

/// The loss of a tile at the labels `at` [V] of the visible Gaussians. Writes the slots of all its Gaussians: the same
/// sums as of a block in which every Gaussian is a column.
TileLoss evaluate_tile(const RecordedTile& tile, ColumnValues at, TargetPlanes targets, SlotSums* slots);

}  // namespace ngs
