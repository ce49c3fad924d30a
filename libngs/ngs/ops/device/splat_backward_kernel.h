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
  static constexpr int kSums = kPairGeometry + C;
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
    StagedGaussians<C, kChunk> staged;
    float grad[C + 1][kTilePixels];
    union {
      Pairs pair;
      float column[kTilePx][kChunk * kSums + 1];  // odd rows: a warp writes columns and reads rows, each in 32 banks
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
    const float* const rows = checkpoints.of(begin, block.index);
    for (int chunk = checkpoints.count[block.index]; chunk-- > 0;) {
      const std::int64_t first = begin + std::int64_t(chunk) * kChunk;
      const int used = int(min2<std::int64_t>(kChunk, end - first));
      const bool some_live = block.any([&](int t, Shared& shared, Thread& own) {
        shared.staged.template load<kThreads>(t, tiles, frame, channels, {first, used});
        const float checkpoint = rows[chunk * kTilePixels + t];
        own.traversal = {checkpoint, checkpoint >= 0.f};
        return own.traversal.live;
      });
      if (!some_live) continue;
      gradients_of_pixels(block, frame, used);
      sums_of_pairs(block, first, used);
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
    return some;
  }

  /// ∂L/∂α = T (v - s), v = Σ_c g_c c_i + g_alpha, s <- α v + (1 - α) s, from the far end of the chunk: leaves
  /// ∂L/∂power and the weight of every (Gaussian, pixel).
  template <class Block>
  NGS_HD void gradients_of_pixels(Block& block, const TileFrame& frame, int used) const {
    block.phase([&](int t, Shared& shared, Thread& own) {
      const TilePixel pixel(t, frame);
      for (int j = 0; j < used; ++j) {
        float before;
        shared.pair.first[j][chunk_place(j, t)] =
            own.traversal.pass(shared.staged.gaussian[j], float(pixel.column), float(pixel.row), tiles.stop, before);
        shared.pair.second[j][chunk_place(j, t)] = before;
      }
      float g[C + 1];
      for (int c = 0; c <= C; ++c) g[c] = shared.grad[c][t];
      for (int j = used; j-- > 0;) {
        float &first = shared.pair.first[j][chunk_place(j, t)], &second = shared.pair.second[j][chunk_place(j, t)];
        const float opaque = first, weight = opaque * second;
        float v = g[C];
        for (int c = 0; c < C; ++c) v = fma_lanes(g[c], moves >> c & 1 ? shared.staged.value[j][c] : 0.f, v);
        const float difference = v - own.behind;
        own.behind = fma_lanes(opaque, difference, own.behind);
        first = opaque < float(kAlphaCap) ? weight * difference : 0.f;
        second = weight;
      }
    });
  }

  /// Sums over pixels: the gradient rows of the chunk's pairs.
  template <class Block>
  NGS_HD void sums_of_pairs(Block& block, std::int64_t entry, int used) const {
    block.phase([&](int t, Shared& shared, Thread& own) {
      const int j = t / kTilePx;
      if (j < used) sum_column(shared, shared.staged.gaussian[j], j, t % kTilePx, own.part);
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
      const float value =
          of_geometry ? geometry(shared.staged.gaussian[j], shared.total + j * kSums, k) : shared.total[t];
      const std::uint32_t* row_of = sums == DeviceSums::kAtomic ? tiles.gaussian : tiles.slot;
      float* to = row_grad + std::int64_t(row_of[entry + j]) * row_columns + (of_geometry ? k : k + channels.first);
      if (sums == DeviceSums::kAtomic)
        Launcher::atomic_add(to, value);
      else
        *to = of_geometry && channels.first > 0 ? *to + value : value;
    });
  }

  /// Moments of ∂L/∂power in the distance from the mean, and weighted channel gradients, over a column of pixels, as
  /// TileBackward::column() sums them.
  NGS_HD static void sum_column(const Shared& shared, const TileGaussian<float>& g, int j, int x, float* part) {
    float p = 0.f, pv = 0.f, pvv = 0.f, channel[C];
    for (int c = 0; c < C; ++c) channel[c] = 0.f;
    for (int row = 0; row < kTilePx; ++row) {
      const int at = row * kTilePx + x, place = chunk_place(j, at);
      const float v = g.y - float(row), power = shared.pair.first[j][place], weight = shared.pair.second[j][place];
      const float first = power * v;
      p += power, pv += first, pvv = fma_lanes(first, v, pvv);
      for (int c = 0; c < C; ++c) channel[c] = fma_lanes(weight, shared.grad[c][at], channel[c]);
    }
    const float u = g.x - float(x), pu = p * u;
    part[0] = p, part[1] = pu, part[2] = pv, part[3] = pu * u, part[4] = pv * u, part[5] = pvv;
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
