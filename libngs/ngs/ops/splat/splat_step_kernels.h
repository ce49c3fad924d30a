#pragma once
// One Gaussian at one pixel: the inner step of every compositing loop.                Eq. (2); paper.md §5.1
//
// L is a lane type: a pack of pixels on the CPU, one pixel per thread on a device. Every multiply-add is an explicit
// fma, so all lane types compute the same bits.
#include <cmath>
#include <numbers>

#include "ngs/core/hd.h"
#include "ngs/math/lane_scalar.h"

namespace ngs {

inline constexpr double kAlphaCap = 0.99;                    // alpha = min(0.99, 2^exponent)
inline constexpr double kAlphaMin = 1.0 / 255;               // contributions below are skipped
inline constexpr double kLog2AlphaMin = -7.994353436858858;  // log2(kAlphaMin)
inline constexpr double kSpanSlackPx = 0.02;        // exceeds the rounding error of any span; lanes test alpha anyway
inline constexpr double kTransmittanceStop = 1e-4;  // a pixel stops before its transmittance would fall below this

/// The exponent of Eq. (2) at the offset (u, v) from the mean, as a sum of two squares in base 2:
///
///   o e^(-(a u² + 2 b u v + c v²) / 2) = 2^(log2 o - (along_u u + along_v v)² - across v²)
///
/// Along a needle of σ = 1000 px the printed form subtracts terms of 10⁶. Here terms of 10³ cancel before squaring, and
/// rounding cannot make the sum of squares negative. Base 2 needs no reduction by ln 2.
template <class S>
struct PowerForm {
  S along_u, along_v, across;

  /// From the conic's a and b and the variance along y: 1 / variance_yy = c - b²/a.
  [[gnu::always_inline]] NGS_HD static PowerForm of(S a, S b, S variance_yy) {
    using std::sqrt;
    constexpr double kHalf = 0.5 * std::numbers::log2e;
    const S along_u = sqrt(S(kHalf) * a);
    return {along_u, along_u > S(0) ? S(kHalf) * b / along_u : S(0), S(kHalf) / variance_yy};
  }
  /// The conic, up to rounding.
  [[gnu::always_inline]] NGS_HD S a() const { return S(kTwoLn2) * along_u * along_u; }
  [[gnu::always_inline]] NGS_HD S b() const { return S(kTwoLn2) * along_u * along_v; }
  [[gnu::always_inline]] NGS_HD S c() const { return S(kTwoLn2) * (along_v * along_v + across); }
  /// Rows of the conic times (u, v); cancellation is confined to one factor.
  [[gnu::always_inline]] NGS_HD S times_x(S u, S v) const { return S(kTwoLn2) * along_u * (along_u * u + along_v * v); }
  [[gnu::always_inline]] NGS_HD S times_y(S u, S v) const {
    return S(kTwoLn2) * (along_v * (along_u * u + along_v * v) + across * v);
  }

 private:
  static constexpr double kTwoLn2 = 2 * std::numbers::ln2;
};

/// The part of the exponent that is constant in a row: log2 o - across v².
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_row_constant(L across, L v, L log2_opacity) {
  return fma_lanes(-(across * v), v, log2_opacity);
}
/// linear = along_v v. The result is at most `constant`, also after rounding.
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_exponent(L u, L along_u, L linear, L constant) {
  const L along = fma_lanes(along_u, u, linear);
  return fma_lanes(-along, along, constant);
}
/// Lanes with alpha >= 1/255, decided from the exponent: does not wait for the exponential.
template <class L>
[[gnu::always_inline]] NGS_HD inline typename LaneTraits<L>::Mask splat_reaches(typename LaneTraits<L>::Mask visited,
                                                                                L exponent) {
  using S = typename LaneTraits<L>::Scalar;
  return and_at_least(visited, exponent, L(S(kLog2AlphaMin)));
}
/// Alpha; 0 in lanes that are not reached.
template <class L>
[[gnu::always_inline]] NGS_HD inline L splat_alpha(typename LaneTraits<L>::Mask reached, L exponent) {
  return min_lanes(L(typename LaneTraits<L>::Scalar(kAlphaCap)), exp2_where(reached, exponent));
}
/// The transmittance behind a Gaussian.
template <class L>
[[gnu::always_inline]] NGS_HD inline L attenuate(L alpha, L before) {
  return fma_lanes(-alpha, before, before);
}

/// A Gaussian relative to the first pixel centre of a tile.
template <class S>
struct TileGaussian {
  S x, y, log2_opacity;
  PowerForm<S> form;
};

/// State of a pixel while the Gaussians of its tile are composited front to back.
template <class S>
struct PixelTraversal {
  S transmittance;
  bool live;

  /// Composites Gaussian `g` at column x, row y of the tile; returns its alpha, 0 if it does not contribute. `before`:
  /// the transmittance in front of it. The pixel stops before its transmittance would fall below `stop`.
  NGS_HD S pass(const TileGaussian<S>& g, S x, S y, S stop, S& before) {
    before = transmittance;
    const S u = g.x - x, v = g.y - y;
    const S exponent =
        splat_exponent(u, g.form.along_u, g.form.along_v * v, splat_row_constant(g.form.across, v, g.log2_opacity));
    if (!splat_reaches(live, exponent)) return S(0);
    const S alpha = splat_alpha(true, exponent);
    const S after = attenuate(alpha, before);
    live = after >= stop;
    if (!live) return S(0);
    transmittance = after;
    return alpha;
  }
};

}  // namespace ngs
