#pragma once
// One Gaussian at one pixel: the step that every compositing walk repeats.            Eq. (2); PAPER.md §5.1
//
// L is a lane type: a pack of pixels on the CPU, one pixel in a thread of a device. Every product that is summed is an
// explicit fma, so all of them compute the same bits.
#include <numbers>

#include "ngs/core/hd.h"
#include "ngs/math/lane_scalar.h"

namespace ngs {

inline constexpr double kAlphaCap = 0.99;        // alpha = min(0.99, 2^exponent)
inline constexpr double kAlphaMin = 1.0 / 255;   // contributions below are skipped
inline constexpr double kLog2AlphaMin = -7.994353436858858;  // log2 of it
inline constexpr double kSpanSlackPx = 0.02;     // more than the rounding of any span; lanes test alpha anyway
inline constexpr double kTransmittanceStop = 1e-4;  // a pixel ends before its transmittance falls below

/// The exponent of Eq. (2) at the offset (u, v) from the mean, for base 2, so that it needs no reduction by ln 2:
/// o e^(-(a u² + 2 b u v + c v²) / 2) = 2^(uu u² + uv u v + vv v² + log2 o).
template <class S>
struct PowerForm {
  S uu, uv, vv;

  NGS_HD static PowerForm of_conic(S a, S b, S c) {
    return {S(-0.5 * std::numbers::log2e) * a, S(-std::numbers::log2e) * b, S(-0.5 * std::numbers::log2e) * c};
  }
  /// The conic, up to rounding.
  NGS_HD S a() const { return S(-2 * std::numbers::ln2) * uu; }
  NGS_HD S b() const { return S(-std::numbers::ln2) * uv; }
  NGS_HD S c() const { return S(-2 * std::numbers::ln2) * vv; }
};

/// What the exponent takes from a row, constant in u: vv v² + log2 o.
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_row_constant(L vv, L v, L log2_opacity) {
  return fma_lanes(vv * v, v, log2_opacity);
}
/// linear = uv v.
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_exponent(L u, L uu, L linear, L constant) {
  return fma_lanes(u, fma_lanes(uu, u, linear), constant);
}
/// Where an alpha counts: it is at least 1/255, and the quadratic form is none that rounding made negative. Known before
/// the alpha is, so that nothing waits for it.
template <class L>
[[gnu::always_inline]] NGS_HD inline typename LaneTraits<L>::Mask splat_reaches(typename LaneTraits<L>::Mask visited, L exponent,
                                                                                L log2_opacity) {
  using S = typename LaneTraits<L>::Scalar;
  return and_at_least(and_at_least(visited, log2_opacity, exponent), exponent, L(S(kLog2AlphaMin)));
}
/// 0 in lanes that are not reached.
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_alpha(typename LaneTraits<L>::Mask reached, L exponent) {
  return min_lanes(L(typename LaneTraits<L>::Scalar(kAlphaCap)), exp2_where(reached, exponent));
}
/// The transmittance behind a Gaussian.
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_behind(L alpha, L before) {
  return fma_lanes(-alpha, before, before);
}

/// A Gaussian relative to the first pixel centre of a tile.
template <class S>
struct TileGaussian {
  S x, y, log2_opacity;
  PowerForm<S> form;
};

/// A pixel on its walk.
template <class S>
struct PixelWalk {
  S transmittance;
  bool live;

  /// Passes Gaussian `g` at column x, row y of the tile; returns its alpha, 0 where it is not used. `before` is the
  /// transmittance it meets. A pixel stops before its transmittance would fall below `stop`.
  NGS_HD S pass(const TileGaussian<S>& g, S x, S y, S stop, S& before) {
    before = transmittance;
    const S u = g.x - x, v = g.y - y;
    const S exponent = splat_exponent(u, g.form.uu, g.form.uv * v, splat_row_constant(g.form.vv, v, g.log2_opacity));
    if (!splat_reaches(live, exponent, g.log2_opacity)) return S(0);
    const S alpha = splat_alpha(true, exponent);
    const S after = splat_behind(alpha, before);
    live = after >= stop;
    if (!live) return S(0);
    transmittance = after;
    return alpha;
  }
};

}  // namespace ngs
