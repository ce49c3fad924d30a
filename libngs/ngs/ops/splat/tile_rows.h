#pragma once
// The rows of a band of a tile's columns that a Gaussian can reach: the loops over its pixels visit only these.
// The same text for packs of Gaussians on the CPU and for one Gaussian on a device.                     paper.md §5.1
#include <limits>

#include "ngs/ops/splat/tile_types.h"

namespace ngs {

/// What the rows depend on, for the Gaussians of a lane type G. px are counted from the tile's first pixel centre.
///
// clang-format off
///   mean_x, mean_y, bottom_x, inv_c, inv_det   as in SplatRecord
///   b                                          of the conic
///   cut_c                                      max_mahalanobis2 times c of the conic, with room for rounding
// clang-format on
template <class G>
struct RowEllipse {
  using T = typename LaneTraits<G>::Scalar;
  static constexpr double kEps = std::numeric_limits<T>::epsilon();
  G mean_x, mean_y, b, inv_c, inv_det, cut_c, bottom_x;

  /// Of a Gaussian whose mean is (x, y); G is T.
  template <class S>
  [[gnu::always_inline]] NGS_HD static RowEllipse of(const SplatRecord<S>& g, S x, S y) {
    return {T(x),         T(y),         T(g.form.b()),
            T(g.inv_c),   T(g.inv_det), T(1 + 8 * kEps) * T(g.max_mahalanobis2) * T(g.form.c()),
            T(g.bottom_x)};
  }

  /// The end of the rows downwards (1) or their begin (-1), in [0, rows], for the columns [first, first + count).
  ///
  /// Within the columns the ellipse {quadratic form <= max_mahalanobis2} has its extreme row at its own lowest
  /// (highest) point, or on the column border nearest to it. Rounding may add rows, never remove any: the square and
  /// the border are widened by their cancellation error. If the ellipse misses the columns, at most one row is visited
  /// in vain.
  [[gnu::always_inline]] NGS_HD G border(T downwards, int first, int count, int rows) const {
    const G left = G(T(first - kSpanSlackPx)) - mean_x, right = left + G(T(count - 1 + 2 * kSpanSlackPx));
    const G u = max_lanes(min_lanes(G(downwards) * bottom_x, right), left), along = b * u;
    const G root = sqrt_lanes(max_lanes(fma_lanes(-u * inv_det, u, cut_c), G(T(0))));
    const G v = (G(downwards) * root - along) * inv_c;
    const G slack = fma_lanes(max_lanes(along, -along) + root, inv_c * G(T(4 * kEps)), G(T(kSpanSlackPx)));
    const G row = G(downwards) * floor_lanes(fma_lanes(G(downwards), mean_y + v, slack)) + G(T(downwards > 0 ? 1 : 0));
    return min_lanes(max_lanes(row, G(T(0))), G(T(rows)));
  }
};

}  // namespace ngs
