#pragma once
// Compact weights of one tile, with the types of their inputs and results. Internal to ops (label_system.cpp).
#include <vector>

#include "ngs/math/lanes.h"
#include "ngs/ops/splat/splat_tiles.h"
#include "ngs/ops/splat/tile_scratch.h"

namespace ngs {

using LabelPack = PackF;
inline constexpr int kLabelPacks = kPacksPerTile<LabelPack>;

/// Targets of 8 pixels, and the contribution of the folded Gaussians to their predictions.
struct PixelPack {
  LabelPack inside, outside;         // a, b
  LabelPack foreground, background;  // Σ_folded w m;  T + Σ_folded w (1 - m)
};

/// The columns of one tile, nearest first, and their weights pack by pack. The sums of a pack's pixels then stay in
/// registers, and each weight is loaded once per evaluation.
struct LabelBlock {
  struct Entry {
    std::uint32_t column, slot;
  };
  std::vector<Entry> entry;
  std::vector<PixelPack> pixel;    // reached by at least one column
  std::vector<std::uint32_t> end;  // [pixel] end of its contributions, which begin at the end of the previous pack
  // Contributions. Each has a place, 2 · entry + band: an entry has one sum for columns 0 to 7 of the tile and one for
  // columns 8 to 15. Within a pack, places ascend from 0 by these steps. Steps that exceed one byte are split by
  // weights of 0.
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

/// The labels of the columns: m and 1 - m as floats, each with its own relative accuracy.
struct ColumnValues {
  const float *m, *rest;
};

/// Sums of a slot: P and Q of one (column, tile) pair.
struct SlotSums {
  float inside, outside;
};

/// Targets of a whole view, [H·W] each.
struct TargetPlanes {
  const float *inside, *outside;
};

/// The contributions of a tile, recorded in packs of `lanes` pixels. FactorSink replaces alphas by weights, so it may
/// traverse a tile only once.
struct RecordedTile {
  TileWork<float> work;
  Tape<float>& tape;
  int lanes;
  float* transmittance;  // [kTilePixels] behind the last one, in packs
};

}  // namespace ngs
