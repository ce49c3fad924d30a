#pragma once
// Mask evidence on a device (before Eq. (3)): the sums of ops/splat/evidence_tile.h per (Gaussian, tile) pair, then per
// Gaussian. A thread first traverses one pixel, then sums a column of pixels of one Gaussian, as in
// ops/device/splat_backward_kernel.h. All sums have the order of the CPU, so equal records give equal bits.
#include "ngs/ops/device/tiles_kernel.h"
#include "ngs/ops/image/pixel_window.h"
#include "ngs/scene/evidence.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {

/// The masks of a view on a device.
struct MasksOnDevice {
  const std::uint8_t* known;  // [H·W] or null: all
  const float* target;        // [objects, window]; zero outside
  PixelWindow window;
  int objects;
  bool by_visibility;  // weights are α T², not α T

  NGS_HD float target_at(int object, int x, int y) const {
    const int column = x - window.x0, row = y - window.y0;
    if (column < 0 || column >= window.w || row < 0 || row >= window.h) return 0.f;
    return target[(std::int64_t(object) * window.h + row) * window.w + column];
  }
};

/// The evidence of up to K objects in one launch, from object `first` on; `used` of the K exist. kFront: only what lies
/// in front of a surface counts.
template <int K, bool kFront = false>
struct EvidenceTileOnDevice {
  static constexpr const char* kName = "evidence_tile";
  static constexpr int kThreads = kTilePixels, kMinBlocks = 3, kChunk = 16, kStaged = kThreads;
  static constexpr int kSums = 2 + 2 * K;
  static_assert(kChunk * kTilePx == kThreads, "a thread takes a column of pixels of a Gaussian");
  static_assert(kChunk * kSums <= kThreads);

  TilesOnDevice tiles;
  MasksOnDevice masks;
  int first, used;
  float* pair;  // [pairs, columns]: W, n, then W1, n1 per object; zero where nothing is written
  int columns;
  const float* limit = nullptr;  // [H·W] camera z of the surface, for kFront

  struct Shared {
    StagedGaussian gaussian[kStaged];
    float mask[1 + K][kTilePixels];             // known, targets; 0 where unknown or outside
    float weight[kChunk][kTilePixels];          // at chunk_place()
    float column[kTilePx][kChunk * kSums + 1];  // odd rows, as in the splat's backward pass
  };
  struct Thread {
    PixelTraversal<float> traversal;
    std::uint32_t reached;
    float limit;
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const TileFrame frame = tiles.frame(block.index);
    const std::int64_t begin = tiles.begin[block.index], end = tiles.begin[block.index + 1];
    block.phase([&](int t, Shared& shared, Thread& own) { load_masks(t, frame, shared, own); });
    for (std::int64_t at = begin; at < end; at += kStaged) {
      const int count = int(min2<std::int64_t>(kStaged, end - at));
      block.phase([&](int t, Shared& shared, Thread&) {
        if (t < count) shared.gaussian[t] = StagedGaussian::of(tiles, tiles.gaussian[at + t], frame);
      });
      for (int from = 0; from < count; from += kChunk)
        if (!sum_chunk(block, frame, at + from, from, min2(kChunk, count - from))) return;
    }
  }

 private:
  NGS_HD void load_masks(int t, const TileFrame& frame, Shared& shared, Thread& own) const {
    const TilePixel pixel(t, frame);
    const bool counts = pixel.inside && (masks.known == nullptr || masks.known[pixel.index] != 0);
    own.traversal = {1.f, pixel.inside};
    if constexpr (kFront) own.limit = pixel.inside ? limit[pixel.index] : 0.f;
    shared.mask[0][pixel.place()] = counts ? 1.f : 0.f;
    for (int k = 0; k < K; ++k)
      shared.mask[1 + k][pixel.place()] =
          counts && k < used ? masks.target_at(first + k, frame.x_px + pixel.column, frame.y_px + pixel.row) : 0.f;
  }

  /// Sums the pairs of the chunk that is staged from `from` on; false if all pixels have stopped before.
  template <class Block>
  NGS_HD bool sum_chunk(Block& block, const TileFrame& frame, std::int64_t entry, int from, int count) const {
    find_reached(block, from, count, [](const Shared& shared) { return shared.gaussian; });
    const bool some_live = block.any([&](int t, Shared& shared, Thread& own) {
      const bool was_live = own.traversal.live;
      const TilePixel pixel(t, frame);
      for (std::uint32_t left = own.reached; left != 0; left &= left - 1) {
        const int j = lowest_bit(left);
        float before;
        const float opaque = own.traversal.pass(shared.gaussian[from + j].gaussian, float(pixel.column),
                                                float(pixel.row), tiles.stop, before);
        float weight = opaque * before;
        if constexpr (kFront) weight = shared.gaussian[from + j].depth < own.limit ? weight : 0.f;
        shared.weight[j][chunk_place(j, pixel.place())] = masks.by_visibility ? weight * before : weight;
      }
      return was_live;
    });
    if (!some_live) return false;
    block.phase([&](int t, Shared& shared, Thread&) {
      const int j = t / kTilePx;
      if (j < count) sum_column(shared, shared.gaussian[from + j].rows[t % kTilePx / kBandPx], j, t % kTilePx);
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      const int j = t / kSums, k = t % kSums;
      if (j >= count || k >= 2 + 2 * used) return;
      pair[std::int64_t(tiles.slot[entry + j]) * columns + (k < 2 ? k : k + 2 * first)] =
          sum_of_columns([&](int x) { return shared.column[x][t]; });
    });
    return true;
  }

  NGS_HD static void sum_column(Shared& shared, StagedGaussian::Rows rows, int j, int x) {
    float sum[kSums];
    for (int k = 0; k < kSums; ++k) sum[k] = 0.f;
    for (int row = rows.begin; row < rows.end; ++row) {
      const int at = pixel_place(x, row);
      const float weight = shared.weight[j][chunk_place(j, at)], counts = shared.mask[0][at];
      sum[0] = fma_lanes(weight, counts, sum[0]);
      sum[1] += weight > 0.f ? counts : 0.f;
      for (int k = 0; k < K; ++k) {
        const float m = shared.mask[1 + k][at];
        sum[2 + 2 * k] = fma_lanes(weight, m, sum[2 + 2 * k]);
        sum[3 + 2 * k] += weight > 0.f && mask_is_foreground(m) ? 1.f : 0.f;
      }
    }
    for (int k = 0; k < kSums; ++k) shared.column[x][j * kSums + k] = sum[k];
  }
};

/// The sums of the Gaussians of a view over their pairs: W, n, then W1, n1 per object.
struct PairSums {
  const std::int64_t* slot_begin;  // [N + 1]
  const double* sum;               // [N, columns], undefined without a pair
  int columns;
  NGS_HD double of(std::int64_t i, int column) const {
    return slot_begin[i] < slot_begin[i + 1] ? sum[i * columns + column] : 0.0;
  }
};

/// seen[i]: 1 if W > 0 and the row is wanted.
struct FindSeen {
  static constexpr const char* kName = "find_seen";
  PairSums pairs;
  const std::uint8_t* wanted;  // [N] or null: all
  std::uint32_t* seen;         // [N] out

  NGS_HD void operator()(std::int64_t i) const { seen[i] = (!wanted || wanted[i]) && pairs.of(i, 0) > 0; }
};

/// Gathers the rows with W > 0: their sums, W1 at most W.
struct GatherSeen {
  static constexpr const char* kName = "gather_seen";
  const std::int64_t* place;  // [N + 1]
  PairSums pairs;
  std::uint32_t* row;  // [seen] out
  double* sum;         // [seen, columns] out

  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t at = place[i];
    if (at == place[i + 1]) return;
    row[at] = std::uint32_t(i);
    double* const to = sum + at * pairs.columns;
    for (int c = 0; c < pairs.columns; ++c) {
      const double total = pairs.of(i, c);
      to[c] = c >= 2 && c % 2 == 0 ? min2(total, to[0]) : total;
    }
  }
};

/// The columns of Evidence, with all objects of all Gaussians.
struct EvidenceColumns {
  std::uint64_t *whole, *fraction, *pixels;  // [N]
  std::uint32_t* views;                      // [N]
  ObjectSums* object;                        // [N, K]
  std::uint32_t* touched;                    // [N, K] 1: some view has evidence of the object
};

/// Evidence::add() of the pairs of Gaussian i.
struct AddPairs {
  static constexpr const char* kName = "add_pairs";
  PairSums pairs;
  EvidenceColumns to;

  NGS_HD void operator()(std::int64_t i) const {
    const double w = pairs.of(i, 0), count = pairs.of(i, 1);
    if (!(w > 0)) return;
    ExactSum weight{to.whole[i], to.fraction[i]};
    weight.add(w);
    to.whole[i] = weight.whole;
    to.fraction[i] = weight.fraction;
    to.pixels[i] += std::uint64_t(count);
    to.views[i] += 1;
    const int objects = pairs.columns / 2 - 1;
    for (int k = 0; k < objects; ++k) {
      const double object_w = min2(pairs.of(i, 2 + 2 * k), w), object_count = pairs.of(i, 3 + 2 * k);
      if (object_w == 0 && object_count == 0) continue;
      to.object[i * objects + k].add(ObjectSums::of_view(w, count, object_w, object_count));
      to.touched[i * objects + k] = 1;
    }
  }
};

/// Gathers the touched cells, by Gaussian, then by object.
struct GatherTouched {
  static constexpr const char* kName = "gather_touched";
  const std::int64_t* place;  // [N K + 1]
  const ObjectSums* object;   // [N, K]
  int objects;
  SparseTable<ObjectSums>::Insert* to;  // [touched] out

  NGS_HD void operator()(std::int64_t i) const {
    if (place[i] == place[i + 1]) return;
    to[place[i]] = {std::uint32_t(i / objects), std::uint32_t(i % objects), object[i]};
  }
};

}  // namespace ngs
