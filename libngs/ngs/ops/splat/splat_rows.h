#pragma once
// The rows of a tile that a Gaussian can reach; the loop of splat_tiles.h visits only these.         paper.md §5.1
//
// Computed for kAhead Gaussians at once, one per lane, to hide the latency of the square roots.
#include <type_traits>

#include "ngs/math/lanes.h"
#include "ngs/ops/splat/tile_rows.h"

namespace ngs {

/// Gaussians per batch.
inline constexpr std::uint32_t kAhead = 32;

/// The next batch of a tile's Gaussians, relative to its first pixel centre. Per band of columns: the rows in which
/// alpha can reach 1/255. Bands are at most 8 px wide, so that Pack16 visits the same pixels as two PackF.
template <class L>
class RowsAhead {
  using S = typename LaneTraits<L>::Scalar;
  // Which rows to visit has no derivative.
  using G = std::conditional_t<std::is_arithmetic_v<S>, L, double>;
  using T = typename LaneTraits<G>::Scalar;
  static constexpr int kBandPx = LaneTraits<L>::kLanes < 8 ? LaneTraits<L>::kLanes : 8, kBands = kTilePx / kBandPx;

 public:
  /// Loads Gaussians [first, first + kAhead) of the tile's list, or as many as there are.
  [[gnu::always_inline]] void find(const TileWork<S>& work, std::uint32_t first) {
    const std::uint32_t left = work.entries - first, count = left < kAhead ? left : kAhead;
    for (std::uint32_t k = kAhead; k < left && k < 2 * kAhead; ++k) prefetch(work.record[work.visible[first + k]]);
    for (std::uint32_t k = 0; k < count; ++k) load(k, work.record[work.visible[first + k]], work.frame);
    for (std::uint32_t k = 0; k < count; k += LaneTraits<G>::kLanes)
      for (int band = 0; band < kBands; ++band) find_rows(k, band, work.frame.rows());
  }
  /// Mean of the k-th Gaussian, px from the first pixel centre.
  S x(std::uint32_t k) const { return x_[k]; }
  S y(std::uint32_t k) const { return y_[k]; }
  /// Bit mask of the rows of a band to visit for the k-th Gaussian.
  std::uint32_t rows(std::uint32_t k, int band) const { return rows_[band][k]; }

 private:
  /// For the next find(): the records of a tile are scattered in memory.
  [[gnu::always_inline]] static void prefetch(const SplatRecord<S>& g) {
    __builtin_prefetch(&g);
    __builtin_prefetch(&g + 1);
  }
  [[gnu::always_inline]] void load(std::uint32_t k, const SplatRecord<S>& g, const TileFrame& frame) {
    using W = WideOf<S>;
    x_[k] = S(g.mean_x - W(frame.x_px + 0.5));
    y_[k] = S(g.mean_y - W(frame.y_px + 0.5));
    const RowEllipse<T> of = RowEllipse<T>::of(g, x_[k], y_[k]);
    mean_x_[k] = of.mean_x;
    mean_y_[k] = of.mean_y;
    b_[k] = of.b;
    inv_c_[k] = of.inv_c;
    inv_det_[k] = of.inv_det;
    cut_c_[k] = of.cut_c;
    bottom_x_[k] = of.bottom_x;
  }

  [[gnu::always_inline]] void find_rows(std::uint32_t k, int band, int rows) {
    const RowEllipse<G> of{lanes(mean_x_, k),  lanes(mean_y_, k), lanes(b_, k),       lanes(inv_c_, k),
                           lanes(inv_det_, k), lanes(cut_c_, k),  lanes(bottom_x_, k)};
    const auto border = [&](T downwards) { return of.border(downwards, band * kBandPx, kBandPx, rows); };
    store_row_bits(rows_[band] + k, border(T(-1)), border(T(1)));
  }
  [[gnu::always_inline]] static G lanes(const T* values, std::uint32_t k) {
    G g;
    load_lanes(values + k, g);
    return g;
  }

  S x_[kAhead], y_[kAhead];
  // Initialised, because lanes behind the last Gaussian are computed too.
  T mean_x_[kAhead] = {}, mean_y_[kAhead] = {}, b_[kAhead] = {}, inv_c_[kAhead] = {}, inv_det_[kAhead] = {},
    cut_c_[kAhead] = {}, bottom_x_[kAhead] = {};
  std::uint32_t rows_[kBands][kAhead];
};

}  // namespace ngs
