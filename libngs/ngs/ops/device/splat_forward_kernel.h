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
template <int C, int kCount>
struct StagedGaussians {
  StagedGaussian gaussian[kCount];
  float value[kCount][C];

  /// The thread's part of loading the entries.
  template <int kThreads>
  NGS_HD void load(int thread, const TilesOnDevice& tiles, const TileFrame& frame, const ChannelGroup<C>& channels,
                   const EntryRange& entries) {
    const std::uint32_t* id = tiles.gaussian + entries.first;
    if (thread < entries.count) gaussian[thread] = StagedGaussian::of(tiles, id[thread], frame);
    for (int i = thread; i < entries.count * C; i += kThreads) value[i / C][i % C] = channels.at(id[i / C], i % C);
  }
};

/// The transmittance of the pixels before every kEntries entries of a tile's list, for the backward pass.
struct Checkpoints {
  static constexpr int kEntries = 16;
  float* transmittance = nullptr;  // [rows(), kTilePixels]; negative: the pixel has stopped. null: not wanted
  std::int32_t* count = nullptr;   // [tiles] rows with a pixel that has not stopped

  static std::int64_t rows(std::int64_t pairs, std::int64_t tiles) { return pairs / kEntries + tiles; }
  /// The first row of a tile whose entries begin at `begin`; it has ceil_div(entries, kEntries) of them.
  NGS_HD static std::int64_t first_row(std::int64_t begin, std::int64_t tile) { return begin / kEntries + tile; }
  NGS_HD float* of(std::int64_t begin, std::int64_t tile) const {
    return transmittance + first_row(begin, tile) * kTilePixels;
  }
};

/// kFront: only what lies in front of a surface is added, also where it is behind other Gaussians
/// (ops/splat/front_layer.h).
template <int C, bool kFront = false>
struct SplatForwardTile {
  static constexpr const char* kName = "splat_forward_tile";
  static constexpr int kThreads = kTilePixels, kMinBlocks = 3, kChunk = Checkpoints::kEntries;
  static constexpr int kStaged = kThreads;  // many, because threads wait for three dependent reads of memory
  TilesOnDevice tiles;
  ChannelGroup<C> channels;
  Plane<float> out[C];
  Plane<float> alpha;
  Checkpoints checkpoints;
  const float* limit = nullptr;  // [H·W] camera z of the surface, for kFront

  using Shared = StagedGaussians<C, kStaged>;
  struct Thread {
    PixelTraversal<float> traversal;
    std::uint32_t reached;
    int live_chunks;  // before which the pixel is live
    float limit;
    float sum[C];
  };

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const TileFrame frame = tiles.frame(block.index);
    const std::int64_t begin = tiles.begin[block.index], end = tiles.begin[block.index + 1];
    block.phase([&](int t, Shared&, Thread& own) {
      const TilePixel pixel(t, frame);
      own.traversal = {1.f, pixel.inside};
      own.live_chunks = 0;
      if constexpr (kFront) own.limit = pixel.inside ? limit[pixel.index] : 0.f;
      for (int c = 0; c < C; ++c) own.sum[c] = 0.f;
    });
    for (std::int64_t first = begin; first < end; first += kStaged) {
      const int count = int(min2<std::int64_t>(kStaged, end - first));
      const bool more = block.any([&](int t, Shared& shared, Thread& own) {
        shared.template load<kThreads>(t, tiles, frame, channels, {first, count});
        return own.traversal.live;
      });
      if (!more) break;
      for (int from = 0; from < count; from += kChunk) {
        find_reached(block, from, min2(kChunk, count - from), [](const Shared& shared) { return shared.gaussian; });
        block.each([&](int t, const Shared& shared, Thread& own) {
          own.live_chunks += own.traversal.live;
          if (checkpoints.transmittance != nullptr)
            checkpoints.of(begin, block.index)[(first - begin + from) / kChunk * kTilePixels + t] =
                own.traversal.live ? own.traversal.transmittance : -1.f;
          composite_chunk(TilePixel(t, frame), from, shared, own);
        });
      }
      block.phase([](int, Shared&, Thread&) {});  // before the staged Gaussians are replaced
    }
    if (checkpoints.count != nullptr) store_count(block, int(ceil_div<std::int64_t>(end - begin, kChunk)));
    block.phase([&](int t, Shared&, Thread& own) {
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
  /// Composites those of the chunk of staged Gaussians from `first` on that reach the thread's warp.
  NGS_HD void composite_chunk(const TilePixel& pixel, int first, const Shared& shared, Thread& own) const {
    for (std::uint32_t left = own.reached; left != 0 && own.traversal.live; left &= left - 1) {
      const int k = first + lowest_bit(left);
      float before;
      const float opaque =
          own.traversal.pass(shared.gaussian[k].gaussian, float(pixel.column), float(pixel.row), tiles.stop, before);
      float weight = opaque * before;
      if constexpr (kFront) weight = shared.gaussian[k].depth < own.limit ? weight : 0.f;
      for (int c = 0; c < C; ++c) own.sum[c] = fma_lanes(weight, shared.value[k][c], own.sum[c]);
    }
  }

  /// Stores the number of chunks before which some pixel is live, at most `most`: found by bisection.
  template <class Block>
  NGS_HD void store_count(Block& block, int most) const {
    int least = 0;
    while (least < most) {
      const int middle = (least + most + 1) / 2;
      if (block.any([&](int, Shared&, Thread& own) { return own.live_chunks >= middle; }))
        least = middle;
      else
        most = middle - 1;
    }
    block.phase([&](int t, Shared&, Thread&) {
      if (t == 0) checkpoints.count[block.index] = least;
    });
  }
};

/// The channels of a layer in front of a surface: the values of the candidates, then 1; zeros for other Gaussians.
struct FillLayer {
  static constexpr const char* kName = "fill_layer";
  const std::uint8_t* candidate;  // [N]
  const std::uint32_t* number;    // [N] row of `value`
  const float* value;             // [rows, columns]
  int columns;
  float* channel;  // [N, columns + 1] out

  NGS_HD void operator()(std::int64_t i) const {
    float* const to = channel + i * (columns + 1);
    for (int c = 0; c < columns; ++c) to[c] = candidate[i] ? value[std::int64_t(number[i]) * columns + c] : 0.f;
    to[columns] = candidate[i] ? 1.f : 0.f;
  }
};

}  // namespace ngs
