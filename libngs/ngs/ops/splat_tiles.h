#pragma once
// The compositing walk of one tile and its forward kernel.                           Eq. (2); PAPER.md §5.1
//
// Templated on the lane type L: PackF (8 pixels of one row) or Pack16 in production, one-lane scalars in tests. A tile
// is walked in columns of packs, pack = column · 16 + row; per Gaussian only rows where alpha can reach 1/255 within
// 8 px of columns are visited. Pack16 visits what two PackF visit, so results do not depend on the width.
#include <cmath>

#include "ngs/math/lanes.h"
#include "ngs/ops/splat_step_kernels.h"
#include "ngs/ops/tile_types.h"

namespace ngs {

template <class L>
inline constexpr int kPackColumns = kTilePx / LaneTraits<L>::kLanes;
template <class L>
inline constexpr int kPacksPerTile = kPackColumns<L>* kTilePx;

/// Where pixel (x, y) of a tile lies in a plane of [packs][lanes].
template <class L>
constexpr int place_in_packs(int x, int y) {
  constexpr int kLanes = LaneTraits<L>::kLanes;
  return (x / kLanes * kTilePx + y) * kLanes + x % kLanes;
}

/// One (Gaussian, pixel pack) contribution: what sinks receive.
///   alpha           0 in lanes that the Gaussian does not reach
///   transmittance   before this Gaussian
template <class L>
struct Contribution {
  int pack;
  L alpha, transmittance;
};

/// Bits [begin, end); none if end <= begin. Both in [0, 16].
[[gnu::always_inline]] inline std::uint32_t row_bits(int begin, int end) {
  return ((1u << end) - 1) & ~((1u << begin) - 1);
}

/// A Gaussian's ellipse {quadratic form <= two_cut} relative to a tile's first pixel centre: which rows it can meet
/// within some columns. Exact up to rounding: its lowest point within the columns is its own lowest point, or lies on
/// the border nearest to that. Where it misses the columns, at most a row too many.
template <class S>
struct TileEllipse {
  double mean_x, mean_y, b, inv_c, inv_det, cut_c, bottom_x;

  [[gnu::always_inline]] TileEllipse(const SplatRecord<S>& g, const TileFrame& frame)
      : mean_x(double(g.mean_x) - frame.x_px - 0.5), mean_y(double(g.mean_y) - frame.y_px - 0.5), b(double(g.conic_b)),
        inv_c(double(g.inv_c)), inv_det(double(g.inv_det)), cut_c(double(g.two_cut) * double(g.conic_c)),
        bottom_x(double(g.bottom_x)) {}

  /// Rows within the two bands of 8 columns, as bits below `rows`.
  [[gnu::always_inline]] void rows_of_bands(int rows, std::uint32_t bits[2]) const {
    const Pack4D downwards(1, -1, 1, -1);  // the lower border of a band's rows, the upper one, those of the next band
    const Pack4D left = Pack4D(0, 0, 8, 8) - Pack4D(mean_x + kSpanSlackPx), right = left + Pack4D(7 + 2 * kSpanSlackPx);
    const Pack4D u = max_lanes(min_lanes(downwards * Pack4D(bottom_x), right), left);
    const Pack4D root = sqrt_lanes(max_lanes(Pack4D(cut_c) - u * u * Pack4D(inv_det), Pack4D(0)));
    const Pack4D v = (downwards * root - Pack4D(b) * u) * Pack4D(inv_c);
    const Pack4D whole = floor_lanes(downwards * (Pack4D(mean_y) + v) + Pack4D(kSpanSlackPx));
    const Pack4D row = downwards * whole + Pack4D(1, 0, 1, 0);
    int border[4];
    store_ints(border, min_lanes(max_lanes(row, Pack4D(0)), Pack4D(rows)));
    bits[0] = row_bits(border[1], border[0]), bits[1] = row_bits(border[3], border[2]);
  }

  /// The same for one column.
  [[gnu::always_inline]] std::uint32_t rows_of_column(int column, int rows) const {
    const double left = column - (mean_x + kSpanSlackPx), right = left + 2 * kSpanSlackPx;
    const auto border = [&](double downwards) {
      double u = downwards * bottom_x;
      u = u < right ? u : right, u = u > left ? u : left;
      const double square = cut_c - u * u * inv_det, root = std::sqrt(square > 0 ? square : 0.0);
      const double v = (downwards * root - b * u) * inv_c;
      double row = downwards * std::floor(downwards * (mean_y + v) + kSpanSlackPx) + (downwards > 0 ? 1 : 0);
      row = row > 0 ? row : 0, row = row < rows ? row : rows;
      return int(row);
    };
    return row_bits(border(-1), border(1));
  }
};

/// Rows to visit per column of packs.
template <class L>
struct RowsToVisit {
  using S = typename LaneTraits<L>::Scalar;
  using Mask = typename LaneTraits<L>::Mask;
  static constexpr int kColumns = kPackColumns<L>;
  std::uint32_t bits[kColumns];

  [[gnu::always_inline]] void find(const TileEllipse<S>& ellipse, int rows) {
    if constexpr (kColumns == 2) {
      ellipse.rows_of_bands(rows, bits);
    } else {
      for (int column = 0; column < kColumns; ++column) bits[column] = ellipse.rows_of_column(column, rows);
    }
  }
  [[gnu::always_inline]] Mask reached(int, L alpha, L power) const { return splat_reaches(alpha, power); }
};

/// A pack as wide as the tile: the rows of its two halves, and for every row the lanes of the half that visits it.
template <class L>
  requires(LaneTraits<L>::kLanes == kTilePx)
struct RowsToVisit<L> {
  using S = typename LaneTraits<L>::Scalar;
  using Mask = typename LaneTraits<L>::Mask;
  std::uint32_t bits[1];
  Mask lanes[kTilePx];

  [[gnu::always_inline]] void find(const TileEllipse<S>& ellipse, int rows) {
    std::uint32_t half[2];
    ellipse.rows_of_bands(rows, half);
    bits[0] = half[0] | half[1];
    masks_of_halves(half[0], half[1], lanes);
  }
  [[gnu::always_inline]] Mask reached(int row, L alpha, L power) const {
    // The power is known long before the alpha: only one comparison waits for it.
    return and_at_least(and_nonpositive(lanes[row], power), alpha, L(S(kAlphaMin)));
  }
};

/// What splat_power takes per row of a Gaussian: all rows of the tile at once.
template <class L>
struct RowTerms {
  using S = typename LaneTraits<L>::Scalar;
  S linear[kTilePx], constant[kTilePx];

  [[gnu::always_inline]] RowTerms(L lane, S tile_y, const PowerForm<S>& form) {
    constexpr int kLanes = LaneTraits<L>::kLanes;
    for (int row = 0; row < kTilePx; row += kLanes) {
      const L v = L(tile_y) - (lane + L(S(row)));
      store_lanes(linear + row, L(form.uv) * v), store_lanes(constant + row, L(form.vv) * v * v);
    }
  }
};

/// Rows to visit, and rows that still have a live pixel, are found for so many Gaussians at once. One after the other,
/// the walk would wait for every square root and for the last pixel of the Gaussian before.
inline constexpr std::uint32_t kAhead = 32;

/// Bits of the rows with a live lane per column of packs; false if there is none.
template <class L>
bool find_live_rows(const typename LaneTraits<L>::Mask* live, std::uint32_t* rows) {
  std::uint32_t all = 0;
  for (int column = 0; column < kPackColumns<L>; ++column) {
    rows[column] = 0;
    for (int row = 0; row < kTilePx; ++row) rows[column] |= std::uint32_t(any(live[column * kTilePx + row])) << row;
    all |= rows[column];
  }
  return all != 0;
}

/// Walks the tile's Gaussians nearest first and hands each contribution to `sink`:
///   sink.begin(e)                        e = position in the tile's list
///     sink.begin_column(column)          a column of packs that may be reached
///     sink.add(row, Contribution<L>)     zero or more, rows ascending
///     sink.end_column(column)
///   sink.end()
/// Contributions without any lane are left out, unless Sink::kTakesEmpty: a branch that waits for the whole evaluation
/// costs more than an addition of zeros. `transmittance` [packs] is left at its final value. A pixel stops before its
/// transmittance would fall below work.stop; the tile stops when all its pixels have.
///
/// The alphas of a column come first, then what they do to the pixels. In one loop each row would be one long chain of
/// operations, few of which fit into what the processor looks ahead at.
template <class L, class Sink>
[[gnu::always_inline]] inline void composite_tile(const TileWork<typename LaneTraits<L>::Scalar>& work, L* transmittance,
                                                  Sink& sink) {
  using S = typename LaneTraits<L>::Scalar;
  using Mask = typename LaneTraits<L>::Mask;
  using W = WideOf<S>;
  constexpr int kLanes = LaneTraits<L>::kLanes, kColumns = kPackColumns<L>;
  const TileFrame frame = work.frame;
  const int rows = frame.rows(), columns = frame.columns();
  Mask live[kPacksPerTile<L>];
  std::uint32_t live_rows[kColumns];
  L lane;
  iota_lanes(S(0), lane);
  for (int column = 0; column < kColumns; ++column) {
    const int inside = columns - column * kLanes;
    for (int row = 0; row < kTilePx; ++row) {
      transmittance[column * kTilePx + row] = L(S(1));
      live[column * kTilePx + row] = lane < L(S(row < rows ? inside : 0));
    }
  }
  const L stop(work.stop), zero = L(S(0));

  RowsToVisit<L> ahead[kAhead];
  L alpha_of[kTilePx];
  for (std::uint32_t e = 0; e < work.entries; ++e) {
    if (e % kAhead == 0) {
      if (!find_live_rows<L>(live, live_rows)) return;
      for (std::uint32_t k = e; k < work.entries && k < e + kAhead; ++k)
        ahead[k - e].find(TileEllipse<S>(work.record[work.visible[k]], frame), rows);
    }
    const SplatRecord<S>& g = work.record[work.visible[e]];
    const RowsToVisit<L>& to_visit = ahead[e % kAhead];
    const PowerForm<S> form = PowerForm<S>::of_conic(g.conic_a, g.conic_b, g.conic_c);
    const L uu(form.uu), opacity(g.opacity);
    const L tile_x(S(g.mean_x - W(frame.x_px + 0.5)));  // relative to the tile: the same bits for any pack width
    const RowTerms<L> terms(lane, S(g.mean_y - W(frame.y_px + 0.5)), form);
    sink.begin(e);
    for (int column = 0; column < kColumns; ++column) {
      const std::uint32_t visited = to_visit.bits[column] & live_rows[column];
      if (visited == 0) continue;
      const L u = tile_x - (lane + L(S(column * kLanes)));
      for (std::uint32_t left = visited; left != 0; left &= left - 1) {
        const int row = __builtin_ctz(left);
        const L power = splat_power(u, uu, L(terms.linear[row]), L(terms.constant[row]));
        const L alpha = splat_alpha(opacity, power);
        alpha_of[row] = select(to_visit.reached(row, alpha, power), alpha, zero);
      }
      sink.begin_column(column);
      for (std::uint32_t left = visited; left != 0; left &= left - 1) {
        const int row = __builtin_ctz(left), pack = column * kTilePx + row;
        const L before = transmittance[pack], after = splat_behind(alpha_of[row], before);
        // A lane that is not reached stays as it is, for no transmittance is ever below `stop`.
        const Mask lasts = and_at_least(live[pack], after, stop);
        const L alpha = select(lasts, alpha_of[row], zero);
        live[pack] = lasts;
        transmittance[pack] = select(lasts, after, before);
        if constexpr (!Sink::kTakesEmpty)
          if (!any(alpha > zero)) continue;
        sink.add(row, Contribution<L>{pack, alpha, before});
      }
      sink.end_column(column);
    }
    sink.end();
  }
}

/// The channel values of one Gaussian: C of them in registers, or any number where C = 0.
template <class L, int C>
struct ChannelRow {
  using S = typename LaneTraits<L>::Scalar;
  L value[C > 0 ? C : 1];
  const S* row = nullptr;
  [[gnu::always_inline]] void load(const S* r) {
    row = r;
    for (int c = 0; c < C; ++c) value[c] = L(r[c]);
  }
  [[gnu::always_inline]] L operator[](int c) const {
    if constexpr (C > 0) return value[c];
    return L(row[c]);
  }
};

/// Sums over lanes per channel: C of them in registers, or any number in memory where C = 0.
template <class L, int C>
struct ChannelSums {
  using S = typename LaneTraits<L>::Scalar;
  static constexpr int kLanes = LaneTraits<L>::kLanes;
  L sum[C > 0 ? C : 1];
  S* memory;
  explicit ChannelSums(S* scratch) : memory(scratch) {}
  [[gnu::always_inline]] void clear(int count) {
    for (int c = 0; c < count; ++c) put(c, L(S(0)));
  }
  [[gnu::always_inline]] L get(int c) const {
    if constexpr (C > 0) return sum[c];
    L s;
    load_lanes(memory + c * kLanes, s);
    return s;
  }
  [[gnu::always_inline]] void put(int c, L x) {
    if constexpr (C > 0) {
      sum[c] = x;
    } else {
      store_lanes(memory + c * kLanes, x);
    }
  }
  [[gnu::always_inline]] void sum_each(int count, S* out) const {
    if constexpr (C > 0) {
      sum_lanes_each(sum, C, out);
    } else {
      for (int c = 0; c < count; ++c) out[c] = sum_lanes(get(c));
    }
  }
};

/// Sink that sums the channels: sum[pack][c] += alpha · transmittance · value[c].
template <class L, int C>
struct ChannelSink {
  using S = typename LaneTraits<L>::Scalar;
  static constexpr bool kTakesEmpty = true;
  const TileWork<S>& work;
  ChannelValues<S> value;
  S* sum;  // [packs][count][lanes]
  ChannelRow<L, C> row = {};

  void begin(std::uint32_t e) { row.load(value.row(work.visible[e])); }
  void begin_column(int) {}
  [[gnu::always_inline]] void add(int, const Contribution<L>& k) {
    constexpr int kLanes = LaneTraits<L>::kLanes;
    const int count = C > 0 ? C : value.count;
    const L weight = k.alpha * k.transmittance;
    S* at = sum + k.pack * count * kLanes;
    for (int c = 0; c < count; ++c) {
      L s;
      load_lanes(at + c * kLanes, s);
      store_lanes(at + c * kLanes, fma_lanes(weight, row[c], s));
    }
  }
  void end_column(int) {}
  void end() {}
};

template <class L, int C>
void forward_tile(const ForwardTile<typename LaneTraits<L>::Scalar>& in) {
  using S = typename LaneTraits<L>::Scalar;
  constexpr int kLanes = LaneTraits<L>::kLanes;
  const int count = in.value.count;
  for (int i = 0; i < count * kTilePixels; ++i) in.scratch[i] = S(0);
  L transmittance[kPacksPerTile<L>];
  ChannelSink<L, C> sink{in.work, in.value, in.scratch};
  composite_tile<L>(in.work, transmittance, sink);
  const TileFrame frame = in.work.frame;
  const int rows = frame.rows(), columns = frame.columns();
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column * kLanes < columns; ++column) {
      const int pack = column * kTilePx + row, width = columns - column * kLanes < kLanes ? columns - column * kLanes : kLanes;
      const std::size_t pixel = std::size_t(frame.y_px + row) * std::size_t(frame.width_px) + std::size_t(frame.x_px + column * kLanes);
      for (int c = 0; c <= count; ++c) {
        const Plane<S> plane = in.out[c];
        if (plane.data == nullptr) continue;
        L value;
        if (c < count) {
          load_lanes(in.scratch + (pack * count + c) * kLanes, value);
          value = fma_lanes(transmittance[pack], L(in.background[c]), value);
        } else {
          value = L(S(1)) - transmittance[pack];
        }
        S lanes[kLanes];
        store_lanes(lanes, value);
        S* out = plane.data + pixel * std::size_t(plane.stride);
        for (int x = 0; x < width; ++x) out[x * plane.stride] = lanes[x];
      }
    }
}

}  // namespace ngs
