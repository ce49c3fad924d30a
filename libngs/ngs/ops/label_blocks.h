#pragma once
// Compact weights of one tile and the two products with them. Internal to ops (label_system.cpp).
#include "ngs/ops/splat_view.h"
#include "ngs/ops/tile_scratch.h"

namespace ngs {

using LabelPack = PackF;
inline constexpr int kLabelPacks = kPacksPerTile<LabelPack>;

/// Targets of 8 pixels and what the folded Gaussians contribute to them.
struct PixelPack {
  LabelPack inside, outside;         // a, b
  LabelPack foreground, background;  // Σ_folded w m;  T + Σ_folded w (1 - m)
};

/// The columns of one tile nearest first, with their weights in packs.
struct LabelBlock {
  struct Entry {
    std::uint32_t column, slot, packs;  // packs: number of its (pack, weight) pairs
  };
  std::vector<Entry> entry;
  std::vector<std::uint8_t> pack;  // index into pixel
  std::vector<LabelPack> weight;   // of each (entry, pack)
  std::vector<HalfPack> half;      // the same in half precision, instead of `weight`
  std::vector<PixelPack> pixel;  // reached by at least one column
  double constant_loss = 0;      // -Σ a ln q + b ln c of the pixels that no column reaches
  double target_sum = 0;         // Σ a + b of the tile
  bool binary = true;            // every target is 0 or 1, and only one of a pixel's two is 1

  void clear() {
    entry.clear(), pack.clear(), weight.clear(), half.clear(), pixel.clear();
    constant_loss = target_sum = 0, binary = true;
  }
  std::int64_t bytes() const {
    return std::int64_t(sizeof(LabelBlock) + entry.size() * sizeof(Entry) +
                        weight.size() * sizeof(LabelPack) + half.size() * sizeof(HalfPack) + pack.size() +
                        pixel.size() * sizeof(PixelPack));
  }
};

/// What the columns stand at: m and 1 - m as floats, each with its own relative accuracy.
struct ColumnValues {
  const float *m, *rest;
};

/// Sums over a slot: P and Q of one (column, tile) pair.
struct SlotSums {
  float inside, outside;
};

/// The block's part of Σ a ln q + b ln c, negated; writes its entries' slots.
double evaluate_block(const LabelBlock& block, ColumnValues at, SlotSums* slots);

/// Where a Gaussian's label is, for collect_block: its column, or -1 and the folded value.
struct LabelPlaces {
  const std::uint32_t* id;     // [V] Gaussians that the view shows
  const std::int32_t* column;  // [N]
  const double* label;         // [N]
};

/// Targets of a whole view, [H·W] each.
struct TargetPlanes {
  const float *inside, *outside;
};

/// Loss and targets of a tile.
struct TileLoss {
  double loss = 0;        // -Σ a ln q + b ln c
  double target_sum = 0;  // Σ a + b
};

/// A tile's contributions by `record` of packs of `lanes` pixels. Who walks it overwrites alphas with weights: once.
struct RecordedTile {
  TileWork<float> work;
  Tape<float>& tape;
  int lanes;
  float* transmittance;  // [kTilePixels] behind the last one, in packs
};

/// The sums of all Gaussians of the tile, which stand at `at` [V]; writes their slots. The same sums as those of a block
/// whose columns are all Gaussians.
TileLoss evaluate_tile(const RecordedTile& tile, ColumnValues at, TargetPlanes targets, SlotSums* slots);

/// Composites the tile and collects its block, in half precision if wanted; slots are those of the view's lists.
void collect_block(const TileWork<float>& work, LabelPlaces places, TargetPlanes targets, bool half, LabelBlock& out);

/// The block with only the columns whose `new_column` is >= 0, renumbered; the others are folded at their
/// values. Its constant_loss is that of the pixels which no column reaches any more; its target_sum is 0.
LabelBlock reduced_block(const LabelBlock& block, const std::int32_t* new_column, ColumnValues at);

}  // namespace ngs
