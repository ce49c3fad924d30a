#pragma once
// Compositing one tile on a device: a thread is a pixel, a block a tile. The same steps in the same order as on the CPU
// (ops/splat/splat_step_kernels.h), so equal records give bit-identical images. See Eq. (2).
#include "ngs/ops/device/tiles_kernel.h"

namespace ngs {

/// C of the `stride` channels of every Gaussian, from channel `first` on. Channels from `used` on are 0,
/// with null planes.
template <int C>
struct ChannelGroup {
  const float* data;  // [N, stride]
  int stride, first, used;
  float background[C];
  NGS_HD float at(std::uint32_t gaussian, int c) const {
    return c < used ? data[std::int64_t(gaussian) * stride + first + c] : 0.f;
  }
};

/// Entries [first, first + count) of the lists of tiles.
struct EntryRange {
  std::int64_t first;
  int count;
};

/// The Gaussians that a block works on next.
template <int C, int kBatch>
struct StagedGaussians {
  TileGaussian<float> gaussian[kBatch];
  float value[kBatch][C];

  /// The thread's part of loading the entries.
  template <int kThreads>
  NGS_HD void load(int thread, const TilesOnDevice& tiles, const TileFrame& frame, const ChannelGroup<C>& channels,
                   const EntryRange& entries) {
    const std::uint32_t* id = tiles.gaussian + entries.first;
    if (thread < entries.count) gaussian[thread] = tile_gaussian(tiles.record[id[thread]], frame);
    for (int i = thread; i < entries.count * C; i += kThreads) value[i / C][i % C] = channels.at(id[i / C], i % C);
  }
};

/// The transmittance of the pixels before every kEntries entries of a tile's list, for the backward pass.
struct Checkpoints {
  static constexpr int kEntries = 16;
  float* transmittance = nullptr;  // [rows(), kTilePixels]; negative: the pixel has stopped. null: not wanted
  std::int32_t* count = nullptr;   // [tiles] rows that the forward pass has written

  static std::int64_t rows(std::int64_t pairs, std::int64_t tiles) { return pairs / kEntries + tiles; }
  /// The first row of a tile whose entries begin at `begin`; it has ceil_div(entries, kEntries) of them.
  NGS_HD static std::int64_t first_row(std::int64_t begin, std::int64_t tile) { return begin / kEntries + tile; }
  NGS_HD float* of(std::int64_t begin, std::int64_t tile) const {
    return transmittance + first_row(begin, tile) * kTilePixels;
  }
};

template <int C>
struct SplatForwardTile {
  static constexpr const char* kName = "splat_forward_tile";
  static constexpr int kThreads = kTilePixels, kMinBlocks = 4, kBatch = 64;
  static_assert(kBatch % Checkpoints::kEntries == 0);
  TilesOnDevice tiles;
  ChannelGroup<C> channels;
  Plane<float> out[C];
  Plane<float> alpha;
  Checkpoints checkpoints;

  using Shared = StagedGaussians<C, kBatch>;
  struct Thread {
    PixelTraversal<float> traversal;
    float sum[C];
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const TileFrame frame = tiles.frame(block.index);
    const std::int64_t begin = tiles.begin[block.index], end = tiles.begin[block.index + 1];
    block.phase([&](int t, Shared&, Thread& own) {
      own.traversal = {1.f, TilePixel(t, frame).inside};
      for (int c = 0; c < C; ++c) own.sum[c] = 0.f;
    });
    std::int64_t first = begin;
    for (; first < end; first += kBatch) {
      const int count = int(min2<std::int64_t>(kBatch, end - first));
      const bool more = block.any([&](int t, Shared& shared, Thread& own) {
        shared.template load<kThreads>(t, tiles, frame, channels, {first, count});
        return own.traversal.live;
      });
      if (!more) break;
      block.phase([&](int t, Shared& shared, Thread& own) {
        const TilePixel pixel(t, frame);
        if (checkpoints.transmittance == nullptr) return composite(pixel, 0, count, shared, own);
        float* row = checkpoints.of(begin, block.index) + (first - begin) / Checkpoints::kEntries * kTilePixels + t;
        for (int k = 0; k < count; k += Checkpoints::kEntries, row += kTilePixels) {
          *row = own.traversal.live ? own.traversal.transmittance : -1.f;
          composite(pixel, k, min2(count, k + Checkpoints::kEntries), shared, own);
        }
      });
    }
    block.phase([&](int t, Shared&, Thread& own) {
      if (t == 0 && checkpoints.count != nullptr)
        checkpoints.count[block.index] = int(ceil_div<std::int64_t>(min2(first, end) - begin, Checkpoints::kEntries));
      const TilePixel pixel(t, frame);
      if (!pixel.inside) return;
      for (int c = 0; c < C; ++c)
        if (out[c].data != nullptr)
          out[c].data[pixel.index * out[c].stride] =
              fma_lanes(own.traversal.transmittance, channels.background[c], own.sum[c]);
      if (alpha.data != nullptr) alpha.data[pixel.index * alpha.stride] = 1.f - own.traversal.transmittance;
    });
  }

 private:
  /// Composites the staged Gaussians [from, to) at the thread's pixel.
  NGS_HD void composite(const TilePixel& pixel, int from, int to, const Shared& shared, Thread& own) const {
    for (int k = from; k < to && own.traversal.live; ++k) {
      float before;
      const float opaque =
          own.traversal.pass(shared.gaussian[k], float(pixel.column), float(pixel.row), tiles.stop, before);
      const float weight = opaque * before;
      for (int c = 0; c < C; ++c) own.sum[c] = fma_lanes(weight, shared.value[k][c], own.sum[c]);
    }
  }
};

}  // namespace ngs
