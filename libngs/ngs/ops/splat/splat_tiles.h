#pragma once
// The compositing loop of one tile and its forward kernel.                           Eq. (2); paper.md §5.1
//
// Templated on the lane type L: PackF (8 pixels of one row) or Pack16 in production, one-lane scalars in tests. A tile
// consists of columns of packs, pack = column · 16 + row. Per Gaussian and band of 8 px only rows where alpha can reach
// 1/255 are visited. Pack16 visits the same pixels as two PackF, so results do not depend on the width.
#include <cmath>
#include <type_traits>

#include "ngs/math/lanes.h"
#include "ngs/ops/splat/splat_rows.h"

namespace ngs {

template <class L>
inline constexpr int kPackColumns = kTilePx / LaneTraits<L>::kLanes;
template <class L>
inline constexpr int kPacksPerTile = kPackColumns<L>* kTilePx;

/// Index of pixel (x, y) of a tile in a plane of [packs][lanes].
template <class L>
constexpr int place_in_packs(int x, int y) {
  constexpr int kLanes = LaneTraits<L>::kLanes;
  return (x / kLanes * kTilePx + y) * kLanes + x % kLanes;
}

/// One (Gaussian, pixel pack) contribution, passed to sinks.
///
///   alpha           0 in lanes that the Gaussian does not reach
///   transmittance   in front of this Gaussian
template <class L>
struct Contribution {
  std::uint32_t pack;
  L alpha, transmittance;
};

/// Rows to visit per column of packs.
template <class L>
struct RowsToVisit {
  using Mask = typename LaneTraits<L>::Mask;
  RowsAhead<L> ahead;

  [[gnu::always_inline]] void find(const TileWork<typename LaneTraits<L>::Scalar>& work, std::uint32_t first) {
    ahead.find(work, first);
  }
  std::uint32_t rows(std::uint32_t k, int column) const { return ahead.rows(k, column); }
  [[gnu::always_inline]] Mask lanes(std::uint32_t, std::uint32_t) const { return all_lanes(L()); }
};

/// For a pack as wide as the tile: the rows of its two halves, and per row the lanes of the halves that visit it.
template <class L>
requires(LaneTraits<L>::kLanes == kTilePx) struct RowsToVisit<L> {
  using Mask = typename LaneTraits<L>::Mask;
  RowsAhead<L> ahead;
  Mask visits[kAhead][kTilePx];

  [[gnu::always_inline]] void find(const TileWork<typename LaneTraits<L>::Scalar>& work, std::uint32_t first) {
    ahead.find(work, first);
    for (std::uint32_t k = 0; k < kAhead && first + k < work.entries; ++k)
      masks_of_halves(ahead.rows(k, 0), ahead.rows(k, 1), visits[k]);
  }
  std::uint32_t rows(std::uint32_t k, int) const { return ahead.rows(k, 0) | ahead.rows(k, 1); }
  [[gnu::always_inline]] Mask lanes(std::uint32_t k, std::uint32_t row) const { return visits[k][row]; }
};

/// Offsets from pixels `first`, first + 1, ... of a row or column to a mean; lane = 0, 1, ...
template <class L>
[[gnu::always_inline]] inline L offsets_to(L mean, L lane, int first) {
  return mean - (lane + L(typename LaneTraits<L>::Scalar(first)));
}

/// Per-row terms of splat_exponent for a Gaussian, for all rows of the tile.
template <class L>
struct RowTerms {
  using S = typename LaneTraits<L>::Scalar;
  S linear[kTilePx], constant[kTilePx];

  [[gnu::always_inline]] RowTerms(L lane, S tile_y, const PowerForm<S>& form, L log2_opacity) {
    constexpr int kLanes = LaneTraits<L>::kLanes;
    for (int row = 0; row < kTilePx; row += kLanes) {
      const L v = offsets_to(L(tile_y), lane, row);
      store_lanes(linear + row, L(form.along_v) * v);
      store_lanes(constant + row, splat_row_constant(L(form.across), v, log2_opacity));
    }
  }
};

/// Bit mask of the rows with a live lane, per column of packs; false if no lane is live.
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

/// Initial state of the pixels: transmittance 1; live if inside the image.
template <class L>
[[gnu::always_inline]] inline void begin_pixels(const TileFrame& frame, const L& lane, L* transmittance,
                                                typename LaneTraits<L>::Mask* live) {
  using S = typename LaneTraits<L>::Scalar;
  const int rows = frame.rows(), columns = frame.columns();
  for (int column = 0; column < kPackColumns<L>; ++column) {
    const int inside = columns - column * LaneTraits<L>::kLanes;
    for (int row = 0; row < kTilePx; ++row) {
      transmittance[column * kTilePx + row] = L(S(1));
      live[column * kTilePx + row] = lane < L(S(row < rows ? inside : 0));
    }
  }
}

/// Traverses the tile's Gaussians front to back and passes each contribution to `sink`:
///
// clang-format off
///   sink.begin(e)                        e = position in the tile's list
///     sink.begin_column(column)          a column of packs that may be reached
///     sink.add(row, Contribution<L>)     zero or more, rows ascending
///     sink.end_column(column)
///   sink.end()
// clang-format on
///
/// Contributions with alpha 0 in all lanes are skipped, unless Sink::kTakesEmpty: adding zeros costs less than a branch
/// that waits for alpha. On return `transmittance` [packs] is final. A pixel stops before its transmittance would fall
/// below work.stop; the tile stops when all its pixels have stopped.
///
/// All alphas of a column are computed before the pixels are updated. In one loop each row would be one long dependency
/// chain, too long for out-of-order execution to overlap rows.
template <class L, class Sink>
[[gnu::always_inline]] inline void composite_tile(const TileWork<typename LaneTraits<L>::Scalar>& work,
                                                  L* transmittance, Sink& sink) {
  using S = typename LaneTraits<L>::Scalar;
  using Mask = typename LaneTraits<L>::Mask;
  constexpr int kLanes = LaneTraits<L>::kLanes, kColumns = kPackColumns<L>;
  Mask live[kPacksPerTile<L>];
  std::uint32_t live_rows[kColumns];
  L lane;
  iota_lanes(S(0), lane);
  begin_pixels(work.frame, lane, transmittance, live);
  const L stop(work.stop), zero = L(S(0));

  RowsToVisit<L> to_visit;
  L alpha_of[kTilePx];
  for (std::uint32_t e = 0; e < work.entries; ++e) {
    const std::uint32_t k = e % kAhead;
    if (k == 0) {
      // Once per batch: after every Gaussian the loop would wait for its last pixel.
      if (!find_live_rows<L>(live, live_rows)) return;
      to_visit.find(work, e);
    }
    const SplatRecord<S>& g = work.record[work.visible[e]];
    const L along_u(g.form.along_u);
    const L tile_x(to_visit.ahead.x(k));  // relative to the tile: the same bits for any pack width
    const RowTerms<L> terms(lane, to_visit.ahead.y(k), g.form, L(g.log2_opacity));
    sink.begin(e);
    for (int column = 0; column < kColumns; ++column) {
      const std::uint32_t visited = to_visit.rows(k, column) & live_rows[column];
      if (visited == 0) continue;
      const L u = offsets_to(tile_x, lane, column * kLanes);
      for (std::uint32_t left = visited; left != 0; left &= left - 1) {
        const auto row = std::uint32_t(__builtin_ctz(left));
        const L exponent = splat_exponent(u, along_u, L(terms.linear[row]), L(terms.constant[row]));
        alpha_of[row] = splat_alpha(splat_reaches(to_visit.lanes(k, row), exponent), exponent);
      }
      sink.begin_column(column);
      for (std::uint32_t left = visited; left != 0; left &= left - 1) {
        const std::uint32_t row = std::uint32_t(__builtin_ctz(left)), pack = std::uint32_t(column * kTilePx) + row;
        const L before = transmittance[pack], after = attenuate(alpha_of[row], before);
        // A lane that is not reached is unchanged: its transmittance is never below `stop`.
        const Mask lasts = and_at_least(live[pack], after, stop);
        const L alpha = select(lasts, alpha_of[row], zero);
        live[pack] = lasts;
        transmittance[pack] = select(lasts, after, before);
        if (Sink::kTakesEmpty || any(alpha > zero)) sink.add(row, Contribution<L>{pack, alpha, before});
      }
      sink.end_column(column);
    }
    sink.end();
  }
}

/// The channel values of one Gaussian: C of them in registers; C = 0: any number, in memory.
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

/// Per-channel sums of packs: C of them in registers; C = 0: any number, in memory.
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

/// The non-zero channels of a Gaussian if there are few, such as one or two labels of many objects. Zero channels would
/// add nothing to the sums.
template <class S>
struct FewChannels {
  static constexpr int kFew = 4;
  int channel[kFew];
  int count = 0;  // kFew + 1: more than kFew, or unknown
  [[gnu::always_inline]] void find(const S* row, int channels) {
    count = kFew + 1;
    if constexpr (std::is_floating_point_v<S>) {  // a Dual of value 0 may have a derivative
      count = 0;
      for (int c = 0; c < channels && count <= kFew; ++c)
        if (row[c] != S(0)) {
          if (count < kFew) channel[count] = c;
          ++count;
        }
    }
  }
  bool known() const { return count <= kFew; }
};

/// Sink that sums the channels: sum[pack][c] += alpha · transmittance · value[c].
template <class L, int C>
struct ChannelSink {
  using S = typename LaneTraits<L>::Scalar;
  static constexpr bool kTakesEmpty = true;
  static constexpr int kLanes = LaneTraits<L>::kLanes;
  const TileWork<S>& work;
  ChannelValues<S> value;
  S* sum;  // [packs][count][lanes]
  ChannelRow<L, C> row = {};
  FewChannels<S> few = {};

  void begin(std::uint32_t e) {
    const S* values = value.row(work.visible[e]);
    row.load(values);
    if constexpr (C == 0) {
      constexpr std::uint32_t kPrefetchEntries = 8;  // rows of many channels miss the cache
      if (e + kPrefetchEntries < work.entries) __builtin_prefetch(value.row(work.visible[e + kPrefetchEntries]));
      few.find(values, value.count);
    }
  }
  void begin_column(int) {}
  [[gnu::always_inline]] void add(std::uint32_t, const Contribution<L>& k) {
    const int count = C > 0 ? C : value.count;
    const L weight = k.alpha * k.transmittance;
    S* at = sum + std::size_t(k.pack) * std::size_t(count * kLanes);
    if (C == 0 && few.known()) {
      for (int i = 0; i < few.count; ++i) add_to(at, few.channel[i], weight);
      return;
    }
    for (int c = 0; c < count; ++c) add_to(at, c, weight);
  }
  [[gnu::always_inline]] void add_to(S* at, int c, L weight) const {
    L s;
    load_lanes(at + c * kLanes, s);
    store_lanes(at + c * kLanes, fma_lanes(weight, row[c], s));
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
      const int pack = column * kTilePx + row,
                width = columns - column * kLanes < kLanes ? columns - column * kLanes : kLanes;
      const std::size_t pixel = frame.pixel(column * kLanes, row);
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
