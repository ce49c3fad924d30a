#pragma once
// Compact weights of one tile, what they are made from, and what is evaluated on them. Internal to ops
// (label_system.cpp).
#include <vector>

#include "ngs/math/lanes.h"
#include "ngs/ops/splat/splat_tiles.h"
#include "ngs/ops/splat/tile_scratch.h"

namespace ngs {

using LabelPack = PackF;
inline constexpr int kLabelPacks = kPacksPerTile<LabelPack>;

/// Targets of 8 pixels and what the folded Gaussians contribute to them.
struct PixelPack {
  LabelPack inside, outside;         // a, b
  LabelPack foreground, background;  // Σ_folded w m;  T + Σ_folded w (1 - m)
};

/// The columns of one tile nearest first, and their weights pack by pack, so that the sums of a pack's pixels stay in
/// registers and a weight comes from memory once per evaluation.
struct LabelBlock {
  struct Entry {
    std::uint32_t column, slot;
  };
  std::vector<Entry> entry;
  std::vector<PixelPack> pixel;    // reached by at least one column
  std::vector<std::uint32_t> end;  // [pixel] of the pack's contributions, which begin where those of the last one end
  // Contributions. Each has a place, 2 · entry + band: an entry has one sum for columns 0 to 7 of the tile and one for
  // the others. Within a pack places ascend from 0 by these steps; where one byte does not reach, weights of 0 stand
  // between.
  std::vector<std::uint8_t> step;
  std::vector<LabelPack> weight;
  std::vector<HalfPack> half;  // the same in half precision, instead of `weight`
  double constant_loss = 0;    // -Σ a ln q + b ln c of the pixels that no column reaches
  double target_sum = 0;       // Σ a + b of the tile
  bool binary = true;          // every target is 0 or 1, and only one of a pixel's two is 1

  std::int64_t bytes() const {
    return std::int64_t(sizeof(LabelBlock) + entry.size() * sizeof(Entry) + pixel.size() * sizeof(PixelPack) +
                        end.size() * sizeof(std::uint32_t) + step.size() + weight.size() * sizeof(LabelPack) +
                        half.size() * sizeof(HalfPack));
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

/// Targets of a whole view, [H·W] each.
struct TargetPlanes {
  const float *inside, *outside;
};

/// A tile's contributions by `record` of packs of `lanes` pixels. Who traverses it overwrites alphas with weights:
/// once.
struct RecordedTile {
  TileWork<float> work;
  Tape<float>& tape;
  int lanes;
  float* transmittance;  // [kTilePixels] behind the last one, in packs
};

}  // namespace ngs
