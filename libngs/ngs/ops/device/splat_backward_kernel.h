#pragma once
// The backward pass of one tile on a device: the adjoint of Eq. (2). With DeviceSums::kInOrder, every (Gaussian, tile)
// pair has one row of gradients, written by one block. With atomic sums, every Gaussian has one row, to which
// its tiles add.
//
// As on the CPU (ops/splat/splat_backward.h), a pixel is traversed from its far end, and nothing is divided by 1 -
// alpha. The traversal is not recorded. Transmittance checkpoints are stored every kBatch entries in global memory and
// every kChunk entries in shared memory; replaying the steps from a checkpoint gives the same bits. Per chunk, the
// threads then change roles: from one pixel with kChunk Gaussians to one Gaussian with eight pixels of half a row. Sums
// over pixels then need no exchange within warps.
#include "ngs/backend/exec.h"
#include "ngs/ops/device/splat_forward_kernel.h"

namespace ngs {

template <int C, class Launcher>
struct SplatBackwardTile {
  static constexpr const char* kName = "splat_backward_tile";
  static constexpr int kThreads = kTilePixels, kBatch = 64, kChunk = 8, kChunks = kBatch / kChunk;
  static constexpr int kSegments = kThreads / kChunk, kSegmentPx = kTilePixels / kSegments;  // 32 of 8 pixels
  static constexpr int kSums = kPairGeometry + C;
  static_assert(kSegmentPx == 8 && kSegments == 32);

  TilesOnDevice tiles;
  ChannelGroup<C> channels;
  Plane<const float> grad[C + 1];  // ∂L/∂(channel), the last one ∂L/∂alpha; null: zero
  std::uint32_t moves;             // bit c: channel c's gradient reaches alpha
  float* checkpoints;              // [checkpoint_rows(), kTilePixels] transmittance; negative: the pixel has stopped
  float* row_grad;                 // [pairs or Gaussians, row_columns], zeros before the first group of channels
  int row_columns;
  DeviceSums sums;

  /// Rows of `checkpoints` for all tiles.
  static std::int64_t checkpoint_rows(std::int64_t pairs, std::int64_t tile_count) {
    return pairs / kBatch + tile_count;
  }
  /// The first row of a tile whose entries begin at `begin`; it has ceil_div(entries, kBatch) of them.
  NGS_HD static std::int64_t first_checkpoint_row(std::int64_t begin, std::int64_t tile) {
    return begin / kBatch + tile;
  }

  struct Pairs {
    float first[kChunk][kTilePixels];   // alpha, then ∂L/∂power
    float second[kChunk][kTilePixels];  // transmittance before, then weight
  };
  struct Shared {
    StagedGaussians<C, kBatch> staged;
    float start[kChunks][kTilePixels];
    float grad[C + 1][kTilePixels];
    union {
      Pairs pair;
      float segment[kSegments][kChunk * kSums + 1];  // odd rows: a warp writes columns and reads rows, each in 32 banks
    };
    float total[kChunk * kSums];
  };
  struct Thread {
    PixelTraversal<float> traversal;
    float behind;
    float part[kSums];
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const TileFrame frame = tiles.frame(block.index);
    const std::int64_t begin = tiles.begin[block.index], end = tiles.begin[block.index + 1];
    if (begin == end) return;
    const bool any_gradient =
        block.any([&](int t, Shared& shared, Thread& own) { return start(t, frame, shared, own); });
    if (!any_gradient) return;  // tiles without a gradient are skipped
    float* const tile_checkpoints = checkpoints + first_checkpoint_row(begin, block.index) * kTilePixels;
    const int batches = traverse(block, frame, begin, end, tile_checkpoints);
    for (int batch = batches; batch-- > 0;) {
      const std::int64_t first = begin + std::int64_t(batch) * kBatch;
      const int count = int(min2<std::int64_t>(kBatch, end - first));
      replay(block, frame, first, count, tile_checkpoints + std::int64_t(batch) * kTilePixels);
      for (int chunk = ceil_div(count, kChunk); chunk-- > 0;) {
        const int from = chunk * kChunk, used = min2(kChunk, count - from);
        gradients_of_pixels(block, frame, chunk, used);
        sums_of_pairs(block, first + from, from, used);
      }
    }
  }

 private:
  /// Loads the pixel's gradient; true if it is not zero.
  NGS_HD bool start(int t, const TileFrame& frame, Shared& shared, Thread& own) const {
    const TilePixel pixel(t, frame);
    bool some = false;
    own.behind = 0.f;
    for (int c = 0; c <= C; ++c) {
      const float g = pixel.inside && grad[c].data ? grad[c].data[pixel.index * grad[c].stride] : 0.f;
      shared.grad[c][t] = g;
      some = some || !(g == 0.f);
      if (c < C && (moves >> c & 1)) own.behind = fma_lanes(g, channels.background[c], own.behind);
    }
    own.traversal = {1.f, pixel.inside};
    return some;
  }

  /// Traverses the tile and stores the transmittances every kBatch entries. Returns the number of batches.
  template <class Block>
  NGS_HD int traverse(Block& block, const TileFrame& frame, std::int64_t begin, std::int64_t end,
                      float* tile_checkpoints) const {
    int batches = 0;
    for (std::int64_t first = begin; first < end; first += kBatch, ++batches) {
      const int count = int(min2<std::int64_t>(kBatch, end - first));
      const bool more = block.any([&](int t, Shared& shared, Thread& own) {
        tile_checkpoints[std::int64_t(batches) * kTilePixels + t] =
            own.traversal.live ? own.traversal.transmittance : -1.f;
        shared.staged.template load<kThreads>(t, tiles, frame, channels, {first, count});
        return own.traversal.live;
      });
      if (!more) break;
      block.phase([&](int t, Shared& shared, Thread& own) {
        const TilePixel pixel(t, frame);
        float before;
        for (int k = 0; k < count && own.traversal.live; ++k)
          own.traversal.pass(shared.staged.gaussian[k], float(pixel.column), float(pixel.row), tiles.stop, before);
      });
    }
    return batches;
  }

  /// Loads a batch again and computes the transmittances at its chunks.
  template <class Block>
  NGS_HD void replay(Block& block, const TileFrame& frame, std::int64_t first, int count,
                     const float* batch_checkpoints) const {
    block.phase([&](int t, Shared& shared, Thread&) {
      shared.staged.template load<kThreads>(t, tiles, frame, channels, {first, count});
    });
    block.phase([&](int t, Shared& shared, Thread& own) {
      const TilePixel pixel(t, frame);
      const float checkpoint = batch_checkpoints[t];
      own.traversal = {checkpoint, checkpoint >= 0.f};
      float before;
      for (int k = 0; k < count; ++k) {
        if (k % kChunk == 0) shared.start[k / kChunk][t] = own.traversal.live ? own.traversal.transmittance : -1.f;
        own.traversal.pass(shared.staged.gaussian[k], float(pixel.column), float(pixel.row), tiles.stop, before);
      }
    });
  }

  /// ∂L/∂α = T (v - s), v = Σ_c g_c c_i + g_alpha, s <- α v + (1 - α) s, from the far end of the chunk: leaves
  /// ∂L/∂power and the weight of every (Gaussian, pixel).
  template <class Block>
  NGS_HD void gradients_of_pixels(Block& block, const TileFrame& frame, int chunk, int used) const {
    block.phase([&](int t, Shared& shared, Thread& own) {
      const TilePixel pixel(t, frame);
      const float start_value = shared.start[chunk][t];
      own.traversal = {start_value, start_value >= 0.f};
      for (int j = 0; j < used; ++j) {
        float before;
        shared.pair.first[j][t] = own.traversal.pass(shared.staged.gaussian[chunk * kChunk + j], float(pixel.column),
                                                     float(pixel.row), tiles.stop, before);
        shared.pair.second[j][t] = before;
      }
      float g[C + 1];
      for (int c = 0; c <= C; ++c) g[c] = shared.grad[c][t];
      for (int j = used; j-- > 0;) {
        const float opaque = shared.pair.first[j][t], weight = opaque * shared.pair.second[j][t];
        float v = g[C];
        for (int c = 0; c < C; ++c)
          v = fma_lanes(g[c], moves >> c & 1 ? shared.staged.value[chunk * kChunk + j][c] : 0.f, v);
        const float difference = v - own.behind;
        own.behind = fma_lanes(opaque, difference, own.behind);
        shared.pair.first[j][t] = opaque < float(kAlphaCap) ? weight * difference : 0.f;
        shared.pair.second[j][t] = weight;
      }
    });
  }

  /// Sums over pixels: the gradient rows of the chunk's pairs.
  template <class Block>
  NGS_HD void sums_of_pairs(Block& block, std::int64_t entry, int from, int used) const {
    block.phase([&](int t, Shared& shared, Thread& own) {
      const int j = t / kSegments, s = t % kSegments;
      if (j < used) sum_segment(shared, shared.staged.gaussian[from + j], j, s, own.part);
    });
    block.phase([&](int t, Shared& shared, Thread& own) {  // overwrites `pair`, which has been read
      const int j = t / kSegments, s = t % kSegments;
      if (j >= used) return;
      for (int k = 0; k < kSums; ++k) shared.segment[s][j * kSums + k] = own.part[k];
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      if (t >= used * kSums) return;
      float sum = 0.f;
      for (int s = 0; s < kSegments; ++s) sum += shared.segment[s][t];
      shared.total[t] = sum;
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      if (t >= used * kSums) return;
      const int j = t / kSums, k = t % kSums;
      const bool of_geometry = k < kPairGeometry;  // to which all channel groups contribute
      if (k >= kPairGeometry + channels.used) return;
      const float value =
          of_geometry ? geometry(shared.staged.gaussian[from + j], shared.total + j * kSums, k) : shared.total[t];
      const std::uint32_t* row_of = sums == DeviceSums::kAtomic ? tiles.gaussian : tiles.slot;
      float* to = row_grad + std::int64_t(row_of[entry + j]) * row_columns + (of_geometry ? k : k + channels.first);
      if (sums == DeviceSums::kAtomic)
        Launcher::atomic_add(to, value);
      else
        *to = of_geometry && channels.first > 0 ? *to + value : value;
    });
  }

  /// Moments of ∂L/∂power in the distance from the mean, and weighted channel gradients, over eight pixels of a row.
  /// The starting pixel shifts with every fourth segment, so that the threads of a warp read from 32 banks.
  NGS_HD static void sum_segment(const Shared& shared, const TileGaussian<float>& g, int j, int s, float* part) {
    float p = 0.f, pu = 0.f, puu = 0.f, channel[C];
    for (int c = 0; c < C; ++c) channel[c] = 0.f;
    for (int i = 0; i < kSegmentPx; ++i) {
      const int x = s % 2 * kSegmentPx + (i + s / 4) % kSegmentPx, at = s / 2 * kTilePx + x;
      const float u = g.x - float(x), power = shared.pair.first[j][at], weight = shared.pair.second[j][at];
      const float first = power * u;
      p += power, pu += first, puu = fma_lanes(first, u, puu);
      for (int c = 0; c < C; ++c) channel[c] = fma_lanes(weight, shared.grad[c][at], channel[c]);
    }
    const int row = s / 2;
    const float v = g.y - float(row);
    part[0] = p, part[1] = pu, part[2] = p * v, part[3] = puu, part[4] = pu * v, part[5] = p * v * v;
    for (int c = 0; c < C; ++c) part[kPairGeometry + c] = channel[c];
  }

  /// ∂L/∂(mean_x, mean_y, conic_a, conic_b, conic_c, log opacity) from the moments p, pu, pv, puu, puv, pvv.
  NGS_HD static float geometry(const TileGaussian<float>& g, const float* m, int k) {
    switch (k) {
      case 0: return -g.form.times_x(m[1], m[2]);
      case 1: return -g.form.times_y(m[1], m[2]);
      case 2: return -0.5f * m[3];
      case 3: return -m[4];
      case 4: return -0.5f * m[5];
      default: return m[0];
    }
  }
};

}  // namespace ngs
