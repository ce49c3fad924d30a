#pragma once
// Projection and tile lists of a view on a device (backend/launcher.h). The lists are those of the CPU
// (ops/splat/splat_view.h), without compaction: Gaussians keep their row numbers, and a Gaussian that reaches no tile
// has no slots.
//
// Pairs (Gaussian, tile) are created in the order of Gaussians and radix-sorted by (tile, depth). The sort is stable,
// so equal depths are ordered by index.
#include "ngs/backend/launcher.h"
#include "ngs/core/check.h"
#include "ngs/ops/splat/splat_gaussian.h"
#include "ngs/ops/splat/tile_rows.h"

namespace ngs {

/// Inputs of the tile kernels. Tile t has the entries [begin[t], begin[t + 1]), nearest first.
struct TilesOnDevice {
  const SplatRecord<float>* record;      // [N]
  const float* depth;                    // [N] camera z
  const std::uint32_t *gaussian, *slot;  // [pairs]
  const std::int64_t* begin;             // [tiles + 1]
  int tiles_x, width_px, height_px;
  float stop;

  NGS_HD TileFrame frame(std::int64_t tile) const {
    return {int(tile % tiles_x) * kTilePx, int(tile / tiles_x) * kTilePx, width_px, height_px};
  }
};

/// A warp is a block of 8 x 4 pixels of a tile: small Gaussians reach few of them.
inline constexpr int kBandPx = 8, kBands = kTilePx / kBandPx, kWarpRows = kWarpThreads / kBandPx;

/// Where the value of a pixel of a tile lies in shared memory, so that neither a warp nor a row of the tile has two
/// values in one bank.
NGS_HD constexpr int pixel_place(int column, int row) {
  return (row * kTilePx + column) ^ (row / (kWarpRows / 2) % 2 * kBandPx);
}
/// The same for Gaussian j of a chunk, so that half a warp with a row of Gaussian j and the other half with this row of
/// j + 1 use all 32 banks.
NGS_HD constexpr int chunk_place(int j, int place) { return place ^ (j % 2 * kTilePx); }

/// The pixel of a thread in its tile.
struct TilePixel {
  int column, row;
  bool inside;
  std::int64_t index;  // into the image
  NGS_HD TilePixel(int thread, const TileFrame& frame)
      : column(thread / kWarpThreads % kBands * kBandPx + thread % kBandPx),
        row(thread / (kWarpThreads * kBands) * kWarpRows + thread % kWarpThreads / kBandPx),
        inside(column < frame.columns() && row < frame.rows()),
        index(std::int64_t(frame.y_px + row) * frame.width_px + frame.x_px + column) {}
  NGS_HD int place() const { return pixel_place(column, row); }
};

/// A Gaussian that the threads of a tile work on, in shared memory.
struct alignas(16) StagedGaussian {
  /// Rows in which it can reach the columns of a band, none if end <= begin.
  struct Rows {
    std::uint8_t begin, end;
  };
  TileGaussian<float> gaussian;
  float depth;  // camera z
  Rows rows[kBands];

  NGS_HD static StagedGaussian of(const TilesOnDevice& tiles, std::uint32_t row, const TileFrame& frame) {
    const SplatRecord<float>& record = tiles.record[row];
    StagedGaussian staged{tile_gaussian(record, frame), tiles.depth[row], {}};
    const auto ellipse = RowEllipse<float>::of(record, staged.gaussian.x, staged.gaussian.y);
    for (int band = 0; band < kBands; ++band) {
      const auto border = [&](float downwards) {
        return std::uint8_t(ellipse.border(downwards, band * kBandPx, kBandPx, frame.rows()));
      };
      staged.rows[band] = {border(-1), border(1)};
    }
    return staged;
  }
  NGS_HD bool reaches(int warp) const {
    const Rows reached = rows[warp % kBands];
    const int first = warp / kBands * kWarpRows;
    return reached.begin < first + kWarpRows && reached.end > first;
  }
};

/// own.reached: bit k is set if Gaussian `first` + k of staged(shared) reaches pixels of the thread's warp, k < count.
template <class Block, class Staged>
NGS_HD void find_reached(Block& block, int first, int count, const Staged& staged) {
  block.ballot(
      [&](int t, const auto& shared) {
        const int k = t % kWarpThreads;
        return k < count && staged(shared)[first + k].reaches(t / kWarpThreads);
      },
      [](auto& own, std::uint32_t bits) { own.reached = bits; });
}

/// column(0) + ... + column(15), in the order of the CPU's packs: folded to 8, then sum_lanes().
template <class Column>
NGS_HD float sum_of_columns(const Column& column) {
  float sum[kTilePx / 2];
  for (int x = 0; x < kTilePx / 2; ++x) sum[x] = 0.f + column(x) + column(x + kTilePx / 2);
  for (int half = kTilePx / 4; half > 0; half /= 2)
    for (int x = 0; x < half; ++x) sum[x] += sum[x + half];
  return sum[0];
}

/// The channel values of Gaussians.
struct ChannelRows {
  ChannelPlan<float> plan;
  float* row = nullptr;  // [N, count] out, of Gaussians that reach a tile; null: not wanted
};

struct ProjectGaussians {
  static constexpr const char* kName = "project_gaussians";
  ViewProjector<float> view;
  CloudView<float> cloud;
  ChannelRows channels;
  SplatRecord<float>* record;  // [N] out, of Gaussians with tiles > 0
  float* depth;                // [N] out
  TileRect* rect;              // [N] out
  std::uint32_t* tiles;        // [N] out: number of tiles that the Gaussian reaches

  NGS_HD void operator()(std::int64_t i) const {
    VisibleGaussian<float> g;
    std::uint32_t reached = 0;
    if (view.project(cloud, i, g)) {
      for (int ty = g.rect.y_begin; ty < g.rect.y_end; ++ty) {
        const TileSpan span = tile_span(g.record, g.rect, ty);
        reached += std::uint32_t(span.end - span.first);
      }
      record[i] = g.record;
      depth[i] = g.depth;
      rect[i] = g.rect;
      if (reached > 0 && channels.row != nullptr)
        channels.plan.fill(view, cloud, i, g.depth, channels.row + i * channels.plan.count());
    }
    tiles[i] = reached;
  }
};

struct MakePairs {
  static constexpr const char* kName = "make_pairs";
  const SplatRecord<float>* record;
  const float* depth;
  const TileRect* rect;
  const std::int64_t* slot_begin;  // [N + 1]
  int tiles_x;
  std::uint64_t* key;      // [pairs] out: tile, then the bits of the depth, which is positive
  std::uint32_t* slot;     // [pairs] out: 0, 1, 2, ...
  std::uint32_t* of_slot;  // [pairs] out: the Gaussian

  NGS_HD void operator()(std::int64_t i) const {
    if (slot_begin[i] == slot_begin[i + 1]) return;
    const std::uint32_t near_first = __builtin_bit_cast(std::uint32_t, depth[i]);
    std::int64_t at = slot_begin[i];
    for (int ty = rect[i].y_begin; ty < rect[i].y_end; ++ty) {
      const TileSpan span = tile_span(record[i], rect[i], ty);
      for (int tx = span.first; tx < span.end; ++tx, ++at) {
        key[at] = std::uint64_t(ty * tiles_x + tx) << 32 | near_first;
        slot[at] = std::uint32_t(at);
        of_slot[at] = std::uint32_t(i);
      }
    }
  }
};

/// The Gaussian of entry i, and the first entry of tile i.
struct FindEntries {
  static constexpr const char* kName = "find_entries";
  const std::uint64_t* key;  // [pairs] sorted
  const std::uint32_t *slot, *of_slot;
  std::int64_t pairs, tiles;
  std::uint32_t* gaussian;  // [pairs] out
  std::int64_t* begin;      // [tiles + 1] out
  NGS_HD void operator()(std::int64_t i) const {
    if (i < pairs) gaussian[i] = of_slot[slot[i]];
    if (i <= tiles) begin[i] = lower_bound_of(key, pairs, std::uint64_t(i) << 32);
  }
};

/// Sums the pairs of every Gaussian that has some, in double. A thread per column: neighbouring threads read
/// neighbouring values, and a Gaussian in many tiles keeps a thread waiting for one column only.
template <class T>
struct SumPairColumns {
  static constexpr const char* kName = "sum_pair_columns";
  const std::int64_t* slot_begin;  // [N + 1]
  const float* pair;               // [pairs, columns]
  int columns;
  T* sum;  // [N, columns] out

  NGS_HD void operator()(std::int64_t i) const {
    const std::int64_t begin = slot_begin[i / columns], end = slot_begin[i / columns + 1];
    if (begin == end) return;
    double total = 0;
    for (std::int64_t slot = begin; slot < end; ++slot) total += double(pair[slot * columns + i % columns]);
    sum[i] = T(total);
  }
};

/// The lists of one view and the memory they live in.
template <class Launcher>
class TileBins {
 public:
  /// All arrays of `cloud` are device pointers. Waits for the number of pairs, to allocate their memory.
  TileBins(Launcher& launcher, const ViewProjector<float>& view, const CloudView<float>& cloud,
           const ChannelRows& channels = {})
      : width_px_(view.width_px),
        height_px_(view.height_px),
        tiles_x_(view.tiles_x),
        tile_count_(std::int64_t(view.tiles_x) * view.tiles_y),
        stop_(float(transmittance_stop(view.compat))),
        record_(launcher, cloud.size),
        depth_(launcher, cloud.size),
        slot_begin_(launcher, cloud.size + 1),
        begin_(launcher, tile_count_ + 1) {
    const DeviceBuffer<Launcher, TileRect> rect(launcher, cloud.size);
    const DeviceBuffer<Launcher, std::uint32_t> tiles(launcher, cloud.size);
    launcher.parallel_for(
        cloud.size, ProjectGaussians{view, cloud, channels, record_.data(), depth_.data(), rect.data(), tiles.data()});
    launcher.exclusive_scan(tiles.data(), slot_begin_.data(), cloud.size);
    launcher.download(&pairs_, slot_begin_.data() + cloud.size, sizeof pairs_);
    NGS_CHECK(pairs_ <= 0xffffffff, "slots are counted in 32 bits");
    const DeviceBuffer<Launcher, std::uint64_t> key(launcher, pairs_);
    const DeviceBuffer<Launcher, std::uint32_t> of_slot(launcher, pairs_);
    slot_ = DeviceBuffer<Launcher, std::uint32_t>(launcher, pairs_),
    gaussian_ = DeviceBuffer<Launcher, std::uint32_t>(launcher, pairs_);
    launcher.parallel_for(cloud.size, MakePairs{record_.data(), depth_.data(), rect.data(), slot_begin_.data(),
                                                tiles_x_, key.data(), slot_.data(), of_slot.data()});
    launcher.sort(key.data(), slot_.data(), pairs_, 32 + bits_of(tile_count_));
    launcher.parallel_for(max2(tile_count_ + 1, pairs_), FindEntries{key.data(), slot_.data(), of_slot.data(), pairs_,
                                                                     tile_count_, gaussian_.data(), begin_.data()});
  }

  TilesOnDevice view() const {
    return {record_.data(), depth_.data(), gaussian_.data(), slot_.data(), begin_.data(),
            tiles_x_,       width_px_,     height_px_,       stop_};
  }
  std::int64_t tiles() const { return tile_count_; }
  std::int64_t gaussians() const { return record_.size(); }
  std::int64_t pairs() const { return pairs_; }
  const std::int64_t* slot_begin() const { return slot_begin_.data(); }  // [N + 1]

 private:
  static int bits_of(std::int64_t n) {
    int bits = 0;
    while ((std::int64_t(1) << bits) < n) ++bits;
    return bits;
  }
  int width_px_, height_px_, tiles_x_;
  std::int64_t tile_count_;
  float stop_;
  std::int64_t pairs_ = 0;
  DeviceBuffer<Launcher, SplatRecord<float>> record_;
  DeviceBuffer<Launcher, float> depth_;
  DeviceBuffer<Launcher, std::int64_t> slot_begin_, begin_;
  DeviceBuffer<Launcher, std::uint32_t> slot_, gaussian_;
};

}  // namespace ngs
