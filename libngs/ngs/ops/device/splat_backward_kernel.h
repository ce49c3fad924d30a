#pragma once
// The backward pass of one tile on a device: the adjoint of Eq. (2). With DeviceSums::kInOrder, every (Gaussian, tile)
// pair has one row of gradients, written by one block. With atomic sums, every Gaussian has one row, to which
// its tiles add.
//
// As on the CPU (ops/splat/splat_backward.h), a pixel is traversed from its far end, and nothing is divided by 1 -
// alpha. The forward pass has stored the transmittances before every chunk of entries (Checkpoints); replaying a chunk
// from there gives the same bits. Per chunk, the threads then change roles: from one pixel with all Gaussians of the
// chunk to one Gaussian with a column of pixels. Sums over pixels then need no exchange within warps, and have the
// order of the CPU: equal records and image gradients give equal bits for up to kMaxChannels channels.
#include "ngs/backend/exec.h"
#include "ngs/ops/device/splat_forward_kernel.h"

namespace ngs {

template <int C, class Launcher>
struct SplatBackwardTile {
  static constexpr const char* kName = "splat_backward_tile";
  static constexpr int kThreads = kTilePixels, kMinBlocks = 3, kChunk = Checkpoints::kEntries;
  static constexpr int kStaged = C > 5 ? 64 : 128, kSums = kPairGeometry + C;  // at most 48 KiB of shared memory
  static_assert(kChunk * kTilePx == kThreads, "a thread takes a column of pixels of a Gaussian");
  static_assert(kChunk * kSums <= kThreads);

  TilesOnDevice tiles;
  ChannelGroup<C> channels;
  Plane<const float> grad[C + 1];  // ∂L/∂(channel), the last one ∂L/∂alpha; null: zero
  std::uint32_t moves;             // bit c: channel c's gradient reaches alpha
  Checkpoints checkpoints;
  float* row_grad;  // [pairs or Gaussians, row_columns], zeros before the first group of channels
  int row_columns;
  DeviceSums sums;

  struct Pairs {                        // at chunk_place()
    float first[kChunk][kTilePixels];   // alpha, then ∂L/∂power
    float second[kChunk][kTilePixels];  // transmittance before, then weight
  };
  struct Shared {
    StagedGaussians<C, kStaged> staged;
    float grad[C + 1][kTilePixels];
    union {
      Pairs pair;
      float column[kTilePx][kChunk * kSums + 1];  // odd rows: a warp writes columns and reads rows, each in 32 banks
    };
    float total[kChunk * kSums];
  };
  struct Thread {
    PixelTraversal<float> traversal;
    std::uint32_t reached;
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
    const int chunks = checkpoints.count[block.index];
    for (int first = chunks == 0 ? -1 : (chunks - 1) * kChunk / kStaged * kStaged; first >= 0; first -= kStaged) {
      const EntryRange entries{begin + first, int(min2<std::int64_t>(kStaged, end - begin - first))};
      block.phase([&](int t, Shared& shared, Thread&) {
        shared.staged.template load<kThreads>(t, tiles, frame, channels, entries);
      });
      for (int from = min2(kStaged, chunks * kChunk - first); (from -= kChunk) >= 0;) {
        const int used = min2(kChunk, entries.count - from);
        find_reached(block, from, used, [](const Shared& shared) { return shared.staged.gaussian; });
        gradients_of_pixels(block, frame, (first + from) / kChunk, from);
        sums_of_pairs(block, entries.first, from, used);
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
      shared.grad[c][pixel.place()] = g;
      some = some || !(g == 0.f);
      if (c < C && (moves >> c & 1)) own.behind = fma_lanes(g, channels.background[c], own.behind);
    }
    return some;
  }

  /// ∂L/∂α = T (v - s), v = Σ_c g_c c_i + g_alpha, s <- α v + (1 - α) s, from the far end of a chunk of the tile, which
  /// is staged from `from` on: leaves ∂L/∂power and the weight of every (Gaussian, pixel) of the warps that it reaches.
  template <class Block>
  NGS_HD void gradients_of_pixels(Block& block, const TileFrame& frame, int chunk, int from) const {
    const float* const row = checkpoints.of(tiles.begin[block.index], block.index) + chunk * kTilePixels;
    block.phase([&](int t, Shared& shared, Thread& own) {
      const TilePixel pixel(t, frame);
      own.traversal = {row[t], row[t] >= 0.f};
      for (std::uint32_t left = own.reached; left != 0; left &= left - 1) {
        const int j = lowest_bit(left), at = chunk_place(j, pixel.place());
        float before;
        shared.pair.first[j][at] = own.traversal.pass(shared.staged.gaussian[from + j].gaussian, float(pixel.column),
                                                      float(pixel.row), tiles.stop, before);
        shared.pair.second[j][at] = before;
      }
      float g[C + 1];
      for (int c = 0; c <= C; ++c) g[c] = shared.grad[c][pixel.place()];
      for (std::uint32_t left = own.reached; left != 0;) {
        const int j = highest_bit(left), at = chunk_place(j, pixel.place());
        left ^= 1u << j;
        float &first = shared.pair.first[j][at], &second = shared.pair.second[j][at];
        const float opaque = first, weight = opaque * second;
        float v = g[C];
        for (int c = 0; c < C; ++c) v = fma_lanes(g[c], moves >> c & 1 ? shared.staged.value[from + j][c] : 0.f, v);
        const float difference = v - own.behind;
        own.behind = fma_lanes(opaque, difference, own.behind);
        first = opaque < float(kAlphaCap) ? weight * difference : 0.f;
        second = weight;
      }
    });
  }

  /// Sums over pixels: the gradient rows of the pairs of the chunk. `entry`: that of the first staged Gaussian.
  template <class Block>
  NGS_HD void sums_of_pairs(Block& block, std::int64_t entry, int from, int used) const {
    block.phase([&](int t, Shared& shared, Thread& own) {
      const int j = t / kTilePx;
      if (j < used) sum_column(shared, shared.staged.gaussian[from + j], j, t % kTilePx, own.part);
    });
    block.phase([&](int t, Shared& shared, Thread& own) {  // overwrites `pair`, which has been read
      const int j = t / kTilePx;
      if (j >= used) return;
      for (int k = 0; k < kSums; ++k) shared.column[t % kTilePx][j * kSums + k] = own.part[k];
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      if (t < used * kSums) shared.total[t] = sum_of_columns([&](int x) { return shared.column[x][t]; });
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      if (t >= used * kSums) return;
      const int j = t / kSums, k = t % kSums;
      const bool of_geometry = k < kPairGeometry;  // to which all channel groups contribute
      if (k >= kPairGeometry + channels.used) return;
      const float value = of_geometry ? geometry(shared.staged.gaussian[from + j].gaussian, shared.total + j * kSums, k)
                                      : shared.total[t];
      const std::uint32_t* row_of = sums == DeviceSums::kAtomic ? tiles.gaussian : tiles.slot;
      float* to =
          row_grad + std::int64_t(row_of[entry + from + j]) * row_columns + (of_geometry ? k : k + channels.first);
      if (sums == DeviceSums::kAtomic)
        Launcher::atomic_add(to, value);
      else
        *to = of_geometry && channels.first > 0 ? *to + value : value;
    });
  }

  /// Moments of ∂L/∂power in the distance from the mean, and weighted channel gradients, over the pixels of a column
  /// that Gaussian j of the chunk can reach, as TileBackward::column() sums them.
  NGS_HD static void sum_column(const Shared& shared, const StagedGaussian& of, int j, int x, float* part) {
    const TileGaussian<float>& g = of.gaussian;
    float p = 0.f, pv = 0.f, pvv = 0.f, channel[C];
    for (int c = 0; c < C; ++c) channel[c] = 0.f;
    const StagedGaussian::Rows rows = of.rows[x / kBandPx];
    for (int row = rows.begin; row < rows.end; ++row) {
      const int at = pixel_place(x, row), place = chunk_place(j, at);
      const float v = g.y - float(row), power = shared.pair.first[j][place], weight = shared.pair.second[j][place];
      const float first = power * v;
      p += power;
      pv += first;
      pvv = fma_lanes(first, v, pvv);
      for (int c = 0; c < C; ++c) channel[c] = fma_lanes(weight, shared.grad[c][at], channel[c]);
    }
    const float u = g.x - float(x), pu = p * u;
    part[0] = p;
    part[1] = pu;
    part[2] = pv;
    part[3] = pu * u;
    part[4] = pv * u;
    part[5] = pvv;
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
