#pragma once
// The compositing loops of one tile, forward and backward.                           Eq. (2); PAPER.md §5.1
//
// Templated on the lane type L: PackF (8 pixels of one row) in production, one-lane scalars in tests. Per
// Gaussian and row only the span where alpha can reach 1/255 is visited.
#include <algorithm>
#include <cmath>
#include <vector>

#include "ngs/math/lanes.h"
#include "ngs/ops/splat_view.h"

namespace ngs {

inline constexpr double kAlphaCap = 0.99;           // alpha = min(0.99, o e^power)
inline constexpr double kAlphaMin = 1.0 / 255;      // contributions below are skipped
inline constexpr double kTransmittanceStop = 1e-4;  // a pixel ends before its transmittance falls below

template <class L>
inline constexpr int kPacksPerRow = kTilePx / LaneTraits<L>::kLanes;
template <class L>
inline constexpr int kPacksPerTile = kPacksPerRow<L>* kTilePx;

/// The pixels of one tile.
struct TileFrame {
  int x_px, y_px;           // first column and row
  int width_px, height_px;  // of the image
  int rows() const { return std::min(kTilePx, height_px - y_px); }
  int columns() const { return std::min(kTilePx, width_px - x_px); }
};

inline TileFrame tile_frame(const TileLists& lists, std::int64_t tile, int width_px, int height_px) {
  return {int(tile % lists.tiles_x) * kTilePx, int(tile / lists.tiles_x) * kTilePx, width_px, height_px};
}

/// One (Gaussian, pixel pack) contribution: what sinks receive.
///   alpha           0 in lanes that the Gaussian does not reach
///   transmittance   before this Gaussian
template <class L>
struct Contribution {
  int pack;
  L alpha, transmittance;
};

/// Walks the tile's Gaussians nearest first and hands each contribution to `sink`:
///   sink.begin(entry)                    entry = position in the tile's list
///   sink.add(const Contribution<L>&)     zero or more, packs ascending
///   sink.end()
/// `transmittance` [packs] is left at its final value. A pixel stops before its transmittance would fall below
/// 1e-4; the tile stops when all its pixels have.
template <class L, class Sink>
void composite_tile(const TileFrame& frame, const TileLists& lists, std::int64_t tile,
                    const std::vector<SplatRecord<typename LaneTraits<L>::Scalar>>& records, Compat compat,
                    L* transmittance, Sink& sink) {
  using S = typename LaneTraits<L>::Scalar;
  using Mask = typename LaneTraits<L>::Mask;
  using W = WideOf<S>;
  constexpr int kLanes = LaneTraits<L>::kLanes, kPerRow = kPacksPerRow<L>;
  Mask live[kPacksPerTile<L>];
  int live_pixels = 0;
  L lane;
  iota_lanes(S(0), lane);
  for (int pack = 0; pack < kPacksPerTile<L>; ++pack) {
    transmittance[pack] = L(S(1));
    const int row = pack / kPerRow, inside = row < frame.rows() ? frame.columns() - pack % kPerRow * kLanes : 0;
    live[pack] = lane < L(S(inside));
    live_pixels += std::clamp(inside, 0, kLanes);
  }
  const L stop(S(compat == Compat::kInria ? kTransmittanceStop : std::nextafter(float(kTransmittanceStop), 1.f)));

  for (std::int64_t entry = lists.tile_begin[std::size_t(tile)]; entry < lists.tile_begin[std::size_t(tile) + 1]; ++entry) {
    if (live_pixels == 0) return;
    const SplatRecord<S>& g = records[lists.visible[std::size_t(entry)]];
    const double a = double(g.conic_a), b_over_a = double(g.conic_b) / a, inv_det = double(g.inv_det);
    const double mean_x = double(g.mean_x) - frame.x_px - 0.5, mean_y = double(g.mean_y) - frame.y_px - 0.5;
    const double reach = double(g.two_cut) * a, half_height = std::sqrt(std::max(0.0, reach / inv_det)) + kSpanSlackPx;
    const int row_begin = clamped_int(std::ceil(mean_y - half_height), 0, frame.rows());
    const int row_end = clamped_int(std::floor(mean_y + half_height) + 1, 0, frame.rows());
    const L conic_a_half(S(-0.5) * g.conic_a), opacity(g.opacity);
    const L tile_x(S(g.mean_x - W(frame.x_px + 0.5)));  // relative to the tile: the same bits for any pack width
    const S tile_y = S(g.mean_y - W(frame.y_px + 0.5));
    sink.begin(entry);
    for (int row = row_begin; row < row_end; ++row) {
      const double dy = row - mean_y;
      const double half = std::sqrt(std::max(0.0, reach - dy * dy * inv_det)) / a + kSpanSlackPx;
      const double middle = mean_x - b_over_a * dy;
      const int first = clamped_int(std::ceil(middle - half), 0, frame.columns()) / kLanes;
      const int last = (clamped_int(std::floor(middle + half) + 1, 0, frame.columns()) + kLanes - 1) / kLanes;
      const S v = tile_y - S(row);
      const L linear(-g.conic_b * v), constant(S(-0.5) * g.conic_c * v * v);
      for (int column = first; column < last; ++column) {
        const int pack = row * kPerRow + column;
        if (!any(live[pack])) continue;
        const L u = tile_x - (lane + L(S(column * kLanes)));
        const L power = fma_lanes(u, fma_lanes(conic_a_half, u, linear), constant);
        const L alpha = min_lanes(L(S(kAlphaCap)), opacity * exp_nonpositive(min_lanes(power, L(S(0)))));
        const Mask reached = live[pack] & (alpha >= L(S(kAlphaMin))) & (power <= L(S(0)));
        const L before = transmittance[pack];
        const L after = fma_lanes(-alpha, before, before);
        const Mask stopped = reached & (after < stop);
        const Mask used = reached & (after >= stop);
        if (any(stopped)) {
          live[pack] = live[pack] & !stopped;
          live_pixels -= count_lanes(stopped);
        }
        if (!any(used)) continue;
        transmittance[pack] = select(used, after, before);
        sink.add(Contribution<L>{pack, select(used, alpha, L(S(0))), before});
      }
    }
    sink.end();
  }
}

/// Sink that sums the channels: out[c][pack] += alpha · transmittance · value[c].
template <class L>
struct ChannelSink {
  using S = typename LaneTraits<L>::Scalar;
  const TileLists& lists;
  Matrix<const S> value;  // [V, C]
  L* sum;                 // [C, packs]
  const S* row = nullptr;

  void begin(std::int64_t entry) { row = value.row(lists.visible[std::size_t(entry)]); }
  void add(const Contribution<L>& k) {
    const L weight = k.alpha * k.transmittance;
    for (int c = 0; c < value.c; ++c) {
      L& s = sum[c * kPacksPerTile<L> + k.pack];
      s = fma_lanes(weight, L(row[c]), s);
    }
  }
  void end() {}
};

/// Sink that records the walk, so that the backward pass can be walked from the far end without dividing by
/// 1 - alpha: 8 bytes per contributing (Gaussian, pixel) pair, at most ~2300 per pixel (T falls by 1/255 each).
template <class L>
struct TapeSink {
  struct Span {
    std::int64_t entry;
    std::size_t begin;
  };
  std::vector<Contribution<L>> contribution;
  std::vector<Span> span;

  void clear() { contribution.clear(), span.clear(); }
  void begin(std::int64_t entry) { span.push_back({entry, contribution.size()}); }
  void add(const Contribution<L>& k) { contribution.push_back(k); }
  void end() {
    if (span.back().begin == contribution.size()) span.pop_back();
  }
};

/// Gradient of one (Gaussian, tile) pair before it is summed per Gaussian: mean, conic, opacity, then channels.
inline constexpr int kPairGeometry = 6;

/// ∂L/∂(record, channel values) of every Gaussian of one tile.
///
///   tape          of composite_tile over the same tile
///   grad          [C + 1, packs]  ∂L/∂(channel sum) and, last, ∂L/∂alpha of the image
///   moves         [C]             whether channel c's gradient reaches alpha
///   background    [C]             value behind everything
///   pair_grad     [pairs, 6 + C]  row lists.slot[entry] is overwritten for every entry with a contribution
///
/// Walked from the far end with s = Σ_c g_c · (colour behind):  ∂L/∂α = T (v - s),  v = Σ_c g_c c_i + g_alpha,
/// s <- α v + (1 - α) s. Exact also where α is capped; the cap itself passes no gradient to its arguments.
template <class L>
void composite_tile_backward(const TileFrame& frame, const TileLists& lists,
                             const std::vector<SplatRecord<typename LaneTraits<L>::Scalar>>& records,
                             Matrix<const typename LaneTraits<L>::Scalar> value, const TapeSink<L>& tape,
                             const L* grad, const std::uint8_t* moves, const typename LaneTraits<L>::Scalar* background,
                             Matrix<typename LaneTraits<L>::Scalar> pair_grad) {
  using S = typename LaneTraits<L>::Scalar;
  using W = WideOf<S>;
  constexpr int kLanes = LaneTraits<L>::kLanes, kPerRow = kPacksPerRow<L>, kPacks = kPacksPerTile<L>;
  const int channels = value.c;
  L behind[kPacks], lane;
  iota_lanes(S(0), lane);
  for (int pack = 0; pack < kPacks; ++pack) {
    behind[pack] = L(S(0));
    for (int c = 0; c < channels; ++c)
      if (moves[c]) behind[pack] = fma_lanes(grad[c * kPacks + pack], L(background[c]), behind[pack]);
  }
  std::vector<L> grad_value(std::size_t(channels), L(S(0)));
  for (std::size_t k = tape.span.size(); k-- > 0;) {
    const std::size_t begin = tape.span[k].begin;
    const std::size_t end = k + 1 < tape.span.size() ? tape.span[k + 1].begin : tape.contribution.size();
    const auto entry = std::size_t(tape.span[k].entry);
    const SplatRecord<S>& g = records[lists.visible[entry]];
    const S* c_i = value.row(lists.visible[entry]);
    const L tile_x(S(g.mean_x - W(frame.x_px + 0.5)));
    const S tile_y = S(g.mean_y - W(frame.y_px + 0.5));
    const L zero = S(0), cap = S(kAlphaCap);
    L p0 = zero, px = zero, py = zero, pxx = zero, pxy = zero, pyy = zero;
    std::fill(grad_value.begin(), grad_value.end(), zero);
    for (std::size_t j = begin; j < end; ++j) {
      const Contribution<L>& hit = tape.contribution[j];
      const L weight = hit.alpha * hit.transmittance;
      L v = grad[channels * kPacks + hit.pack];
      for (int c = 0; c < channels; ++c) {
        const L g_c = grad[c * kPacks + hit.pack];
        if (moves[c]) v = fma_lanes(g_c, L(c_i[c]), v);
        grad_value[std::size_t(c)] = fma_lanes(weight, g_c, grad_value[std::size_t(c)]);
      }
      L& s = behind[hit.pack];
      const L difference = v - s;
      s = fma_lanes(hit.alpha, difference, s);
      // ∂L/∂power = α ∂L/∂α: zero in unreached lanes (α = 0) and where α is capped.
      const L grad_power = select(hit.alpha < cap, weight * difference, zero);
      const L u = tile_x - (lane + L(S(hit.pack % kPerRow * kLanes)));
      const L w(tile_y - S(hit.pack / kPerRow));
      const L gu = grad_power * u, gw = grad_power * w;
      p0 = p0 + grad_power, px = px + gu, py = py + gw;
      pxx = fma_lanes(gu, u, pxx), pxy = fma_lanes(gu, w, pxy), pyy = fma_lanes(gw, w, pyy);
    }
    const S sum_x = sum_lanes(px), sum_y = sum_lanes(py);
    S* out = pair_grad.row(lists.slot[entry]);
    out[0] = -(g.conic_a * sum_x + g.conic_b * sum_y);
    out[1] = -(g.conic_b * sum_x + g.conic_c * sum_y);
    out[2] = S(-0.5) * sum_lanes(pxx);
    out[3] = -sum_lanes(pxy);
    out[4] = S(-0.5) * sum_lanes(pyy);
    out[5] = sum_lanes(p0) / g.opacity;
    for (int c = 0; c < channels; ++c) out[kPairGeometry + c] = sum_lanes(grad_value[std::size_t(c)]);
  }
}

}  // namespace ngs
