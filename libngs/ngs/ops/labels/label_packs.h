#pragma once
// Packs of pixels, tile targets and the traversal of a tile, shared by label_collect.cpp, which builds label blocks,
// and label_evaluate.cpp, which evaluates them.
#include <cmath>

#include "ngs/ops/labels/label_block.h"
#include "ngs/ops/losses/loss_mask_kernels.h"

namespace ngs::label {

using L = LabelPack;
inline constexpr std::size_t kTilePacks = std::size_t(kLabelPacks);
inline constexpr std::uint32_t kBands = kTilePx / L::kLanes;  // of columns, one pack wide; one sum per band

inline L squeezed(L sum) { return fma_lanes(L(float(1 - 2 * kMaskEps)), sum, L(float(kMaskEps))); }

/// -Σ a ln q + b ln c. Logarithms are taken of products of 32 factors, each >= 1e-6: 4 in float, 8 of these in double.
class LossSum {
 public:
  LossSum() { std::fill_n(product_, L::kLanes, 1.0); }

  void add(const PixelPack& p, bool binary) {
    const L fore = squeezed(p.foreground), back = squeezed(p.background);
    binary ? add_binary(p, select(p.inside > L(0.f), fore, back)) : add_weighted(p, fore, back);
  }
  /// Binary targets select one factor per pixel, or none.
  void add_binary(const PixelPack& p, L factor) {
    factor_ = factor_ * select(p.inside + p.outside > L(0.f), factor, L(1.f));
    if (++factors_ % 4 == 0) fold();
  }
  void add_weighted(const PixelPack& p, L q, L c) {
    float inside[L::kLanes], outside[L::kLanes], fore[L::kLanes], back[L::kLanes];
    store_lanes(inside, p.inside);
    store_lanes(outside, p.outside);
    store_lanes(fore, q);
    store_lanes(back, c);
    for (int i = 0; i < L::kLanes; ++i) {
      if (inside[i] != 0.f) weighted_ -= double(inside[i]) * std::log(double(fore[i]));
      if (outside[i] != 0.f) weighted_ -= double(outside[i]) * std::log(double(back[i]));
    }
  }
  double value() {
    fold();
    double sum = weighted_;
    for (const double p : product_) sum -= std::log(p);
    return sum;
  }

 private:
  void fold() {
    float lane[L::kLanes];
    store_lanes(lane, factor_);
    for (int i = 0; i < L::kLanes; ++i) product_[i] *= double(lane[i]);
    factor_ = L(1.f);
  }

  int factors_ = 0;
  L factor_{1.f};
  double product_[L::kLanes], weighted_ = 0;
};

/// The targets of one tile in packs, 0 outside the image.
struct TileTargets {
  L inside[kTilePacks], outside[kTilePacks];
  bool binary = true;

  TileTargets(const TileFrame& frame, TargetPlanes planes) {
    float lane[2][kTilePacks * L::kLanes] = {};
    for (int y = 0; y < frame.rows(); ++y)
      for (int x = 0; x < frame.columns(); ++x) {
        const auto pixel = std::size_t(frame.y_px + y) * std::size_t(frame.width_px) + std::size_t(frame.x_px + x);
        const auto at = std::size_t(place_in_packs<L>(x, y));
        const float a = planes.inside[pixel], b = planes.outside[pixel];
        lane[0][at] = a;
        lane[1][at] = b;
        binary &= (a == 0.f || a == 1.f) && (b == 0.f || b == 1.f) && a * b == 0.f;
      }
    for (std::size_t k = 0; k < kTilePacks; ++k) {
      load_lanes(&lane[0][k * L::kLanes], inside[k]);
      load_lanes(&lane[1][k * L::kLanes], outside[k]);
    }
  }
};

inline L wide(const L& w) { return w; }
inline L wide(const HalfPack& w) { return w.wide(); }

/// Calls f(place, contribution) for the contributions [begin, end) of one pack.
template <class F>
[[gnu::always_inline]] inline void for_each_place(const LabelBlock& block, std::size_t begin, std::size_t end, F&& f) {
  const std::uint8_t* step = block.step.data();
  std::size_t place = 0;
  for (std::size_t i = begin; i < end; ++i) {
    place += step[i];
    f(place, i);
  }
}

/// Passes the contributions of a tile to `sink` in packs of 8 pixels, per entry first those of band 0 (columns 0 to 7),
/// then those of band 1: sink.begin(entry), sink.begin_band(band), sink.add(pack, [lanes] of alpha, then of
/// transmittance `lanes` later), sink.end_band(band), sink.end(). Some packs have no active lane: skipping them costs
/// more than adding zeros.
template <class Sink>
void traverse(const RecordedTile& tile, Sink&& sink) {
  const Tape<float>& tape = tile.tape;
  const int bands = tile.lanes / L::kLanes;  // side by side in the tape
  for (std::size_t k = 0; k < tape.spans;) {
    const std::uint32_t entry = tape.span[k].entry;
    sink.begin(entry);
    for (; k < tape.spans && tape.span[k].entry == entry; ++k) {
      const std::size_t stop = k + 1 < tape.spans ? tape.span[k + 1].begin : tape.size;
      for (int side = 0; side < bands; ++side) {
        const std::size_t band = tape.span[k].column * std::size_t(bands) + std::size_t(side);
        float* lane = tape.lanes + tape.span[k].begin * std::size_t(2 * tile.lanes) + side * L::kLanes;
        sink.begin_band(band);
        for (std::size_t j = tape.span[k].begin; j < stop; ++j, lane += 2 * tile.lanes)
          sink.add(band * kTilePx + tape.row[j], lane);
        sink.end_band(band);
      }
    }
    sink.end();
  }
}

/// The transmittance behind the tile's Gaussians. Wider packs hold the columns of two packs of 8 side by side.
inline L transmittance_of(const RecordedTile& tile, std::size_t pack) {
  const int column = int(pack) / kTilePx * L::kLanes, row = int(pack) % kTilePx;
  L behind;
  load_lanes(tile.transmittance + (column / tile.lanes * kTilePx + row) * tile.lanes + column % tile.lanes, behind);
  return behind;
}

}  // namespace ngs::label
