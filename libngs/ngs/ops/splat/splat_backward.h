#pragma once
// The backward kernel of one tile: record the traversal, then process it from back to front.      paper.md §5.1
#include "ngs/core/prefetch.h"
#include "ngs/ops/splat/splat_tiles.h"

namespace ngs {

/// Sink that records the traversal.
template <class L>
struct TapeSink {
  using S = typename LaneTraits<L>::Scalar;
  static constexpr int kLanes = LaneTraits<L>::kLanes;
  static constexpr bool kTakesEmpty = true;
  Tape<S>& tape;
  std::uint32_t entry = 0;
  // Write positions of the next contribution. Copies of the tape's: a store to a row may alias the tape's own members.
  S* lanes = nullptr;
  std::uint8_t* row_begin = nullptr;
  std::uint8_t* row = nullptr;

  void begin(std::uint32_t e) { entry = e; }
  [[gnu::always_inline]] void begin_column(int column) {
    if ((tape.size + kTilePx) * 2 * kLanes > tape.lane_capacity || tape.spans == tape.span_capacity)
      tape.grow(tape, kLanes);
    tape.span[tape.spans++] = {entry, std::uint32_t(column), tape.size};
    lanes = tape.lanes + tape.size * 2 * kLanes;
    row = row_begin = tape.row + tape.size;
  }
  [[gnu::always_inline]] void add(std::uint32_t r, const Contribution<L>& k) {
    store_lanes(lanes, k.alpha);
    store_lanes(lanes + kLanes, k.transmittance);
    lanes += 2 * kLanes;
    *row++ = std::uint8_t(r);
  }
  [[gnu::always_inline]] void end_column(int) {
    tape.size += std::size_t(row - row_begin);
    if (row == row_begin) --tape.spans;
  }
  void end() {}
};

/// Prefetch distance of the image gradient, in rows.
inline constexpr int kPrefetchGradientRows = 4;

/// Reads ∂L/∂(image) into packs [packs][count + 1][lanes]; false if it is zero everywhere.
template <class L>
bool load_image_gradient(const BackwardTile<typename LaneTraits<L>::Scalar>& in) {
  using S = typename LaneTraits<L>::Scalar;
  constexpr int kLanes = LaneTraits<L>::kLanes;
  const TileFrame frame = in.work.frame;
  const int count = in.value.count, rows = frame.rows(), columns = frame.columns();
  for (int i = 0; i < (count + 1) * kTilePixels; ++i) in.scratch[i] = S(0);
  for (int c = 0; c <= count; ++c) {
    const Plane<const S> plane = in.grad[c];
    if (plane.data == nullptr) continue;
    for (int y = 0; y < rows; ++y) {
      const S* from = plane.data + frame.pixel(0, y) * std::size_t(plane.stride);
      // Rows are short and far apart: the hardware prefetcher misses them.
      const std::size_t ahead = y + kPrefetchGradientRows < rows
                                    ? std::size_t(kPrefetchGradientRows * frame.width_px) * std::size_t(plane.stride)
                                    : 0;
      prefetch_values(from + ahead, columns * plane.stride);
      for (int x = 0; x < columns; x += kLanes) {
        S* to = in.scratch + std::size_t((x / kLanes * kTilePx + y) * (count + 1) + c) * kLanes;
        for (int i = 0; i < kLanes && x + i < columns; ++i) to[i] = from[(x + i) * plane.stride];
      }
    }
  }
  const L zero = L(S(0));
  for (int pack = 0; pack < kPacksPerTile<L> * (count + 1); ++pack) {
    L g;
    load_lanes(in.scratch + std::size_t(pack) * kLanes, g);
    if (any(!((g <= zero) & (zero <= g)))) return true;  // true for NaN too
  }
  return false;
}

/// ∂L/∂(record, channel values) of every Gaussian of one tile.
///
/// Back to front with s = Σ_c g_c · (colour behind):  ∂L/∂α = T (v - s),  v = Σ_c g_c c_i + g_alpha,
/// s <- α v + (1 - α) s. Exact also where α is capped; the cap itself passes no gradient to its arguments.
/// Within a column of packs u is constant, so only Σ g, Σ g w and Σ g w² (g = ∂L/∂power, w = rows from the mean) are
/// summed over rows; the moments in u follow per lane.
template <class L, int C>
class TileBackward {
  using S = typename LaneTraits<L>::Scalar;
  using W = WideOf<S>;
  using F = typename LaneTraits<L>::Folded;
  static constexpr int kLanes = LaneTraits<L>::kLanes;
  static constexpr std::size_t kPrefetchSpans = 6;

 public:
  explicit TileBackward(const BackwardTile<S>& in)
      : in_(in),
        first_x_px_(in.work.frame.x_px + 0.5),
        first_y_px_(in.work.frame.y_px + 0.5),
        totals_(in.scratch + (in.value.count + 1) * kTilePixels + in.value.count * kTilePx) {
    for (std::uint32_t pack = 0; pack < kPacksPerTile<L>; ++pack) {
      L s = L(S(0));
      for (int c = 0; c < count(); ++c) s = fma_lanes(gradient(pack, c), L(in.moves[c] ? in.background[c] : S(0)), s);
      behind_[pack] = s;
    }
  }

  void run() {
    const Tape<S>& tape = *in_.tape;
    std::size_t end = tape.size;
    for (std::size_t k = tape.spans; k-- > 0;) {
      const typename Tape<S>::Span span = tape.span[k];
      const bool first = k + 1 == tape.spans || tape.span[k + 1].entry != span.entry;
      const bool last = k == 0 || tape.span[k - 1].entry != span.entry;
      if (k >= kPrefetchSpans) prefetch(tape.span[k - kPrefetchSpans].entry);
      column(span, end, first, last);
      end = span.begin;
    }
  }

 private:
  /// The Gaussians of a tile are scattered in memory.
  [[gnu::always_inline]] void prefetch(std::uint32_t entry) const {
    __builtin_prefetch(in_.value.row(in_.work.visible[entry]));
    __builtin_prefetch(in_.pair_grad + std::size_t(in_.work.slot[entry]) * std::size_t(kPairGeometry + count()), 1);
  }
  [[gnu::always_inline]] int count() const { return C > 0 ? C : in_.value.count; }
  [[gnu::always_inline]] L gradient(std::uint32_t pack, int c) const {
    L g;
    load_lanes(in_.scratch + std::size_t(pack) * std::size_t((count() + 1) * kLanes) + c * kLanes, g);
    return g;
  }

  /// One column of packs of one entry; `first`, `last`: whether it is the entry's first or last column here.
  [[gnu::always_inline]] void column(const typename Tape<S>::Span& span, std::size_t end, bool first, bool last) {
    const std::uint32_t visible = in_.work.visible[span.entry];
    const SplatRecord<S>& g = in_.work.record[visible];
    const S* values = in_.value.row(visible);
    ChannelRow<L, C> row, moving;
    row.load(values);
    for (int c = 0; c < C; ++c) moving.value[c] = L(in_.moves[c] ? values[c] : S(0));
    L lane;
    iota_lanes(S(0), lane);
    if (first) {
      const L tile_y(S(g.mean_y - first_y_px_));
      for (int r = 0; r < kTilePx; r += kLanes) store_lanes(row_distance_ + r, offsets_to(tile_y, lane, r));
    }
    const L zero = L(S(0)), cap = L(S(kAlphaCap));
    L p0 = zero, py = zero, pyy = zero;
    ChannelSums<L, C> sums(in_.scratch + (count() + 1) * kTilePixels);  // a local variable stays in registers
    sums.clear(count());
    const S* lanes = in_.tape->lanes + span.begin * 2 * kLanes;
    for (std::size_t j = span.begin; j < end; ++j, lanes += 2 * kLanes) {
      const std::uint32_t r = in_.tape->row[j], pack = span.column * kTilePx + r;
      L alpha, transmittance;
      load_lanes(lanes, alpha);
      load_lanes(lanes + kLanes, transmittance);
      const L weight = alpha * transmittance;
      L v = gradient(pack, count());
      for (int c = 0; c < count(); ++c) {
        const L g_c = gradient(pack, c);
        v = fma_lanes(g_c, C > 0 ? moving[c] : L(in_.moves[c] ? values[c] : S(0)), v);
        sums.put(c, fma_lanes(weight, g_c, sums.get(c)));
      }
      const L difference = v - behind_[pack];
      behind_[pack] = fma_lanes(alpha, difference, behind_[pack]);
      // ∂L/∂power = α ∂L/∂α: zero in unreached lanes (α = 0) and where α is capped.
      const L grad_power = select(alpha < cap, weight * difference, zero);
      const L w(row_distance_[r]);
      const L gw = grad_power * w;
      p0 = p0 + grad_power;
      py = py + gw;
      pyy = fma_lanes(gw, w, pyy);
    }
    const L u = offsets_to(L(S(g.mean_x - first_x_px_)), lane, int(span.column) * kLanes);
    const L px = p0 * u;
    const F none = F(S(0));
    const L moment[kPairGeometry] = {p0, px, py, px * u, py * u, pyy};
    for (int i = 0; i < kPairGeometry; ++i) total_[i] = (first ? none : total_[i]) + folded(moment[i]);
    for (int c = 0; c < count(); ++c) totals_.put(c, (first ? none : totals_.get(c)) + folded(sums.get(c)));
    if (!last) return;
    S sum[kPairGeometry];
    sum_lanes_each(total_, kPairGeometry, sum);
    S* out = in_.pair_grad + std::size_t(in_.work.slot[span.entry]) * std::size_t(kPairGeometry + count());
    totals_.sum_each(count(), out + kPairGeometry);
    out[0] = -g.form.times_x(sum[1], sum[2]);
    out[1] = -g.form.times_y(sum[1], sum[2]);
    out[2] = S(-0.5) * sum[3];
    out[3] = -sum[4];
    out[4] = S(-0.5) * sum[5];
    out[5] = sum[0];
  }

  const BackwardTile<S>& in_;
  const W first_x_px_, first_y_px_;  // the tile's first pixel centre
  ChannelSums<F, C> totals_;
  L behind_[kPacksPerTile<L>];
  S row_distance_[kTilePx];  // from each row to the entry's mean, px
  F total_[kPairGeometry];
};

template <class L>
void record_tile(const TileWork<typename LaneTraits<L>::Scalar>& work, Tape<typename LaneTraits<L>::Scalar>& tape,
                 typename LaneTraits<L>::Scalar* transmittance) {
  tape.size = tape.spans = 0;
  L left[kPacksPerTile<L>];
  TapeSink<L> sink{tape};
  composite_tile<L>(work, left, sink);
  for (int pack = 0; pack < kPacksPerTile<L>; ++pack)
    store_lanes(transmittance + pack * LaneTraits<L>::kLanes, left[pack]);
}

template <class L, int C>
void backward_tile(const BackwardTile<typename LaneTraits<L>::Scalar>& in) {
  if (!load_image_gradient<L>(in)) return;  // the loss does not depend on this tile
  in.tape->size = in.tape->spans = 0;
  L transmittance[kPacksPerTile<L>];
  TapeSink<L> sink{*in.tape};
  composite_tile<L>(in.work, transmittance, sink);
  TileBackward<L, C>(in).run();
}

}  // namespace ngs
