#pragma once
// What the compositing kernels ask of a lane type, for lanes that are plain scalars: one lane = one pixel. The packs of
// math/lanes.h offer the same operations; a thread of a device is such a scalar lane.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"

namespace ngs {

template <class L> struct LaneTraits {
  using Scalar = L;
  using Folded = L;
  using Mask = bool;
  static constexpr int kLanes = 1;
};

template <class T> NGS_HD T select(bool m, T a, T b) { return m ? a : b; }
template <class T> NGS_HD bool and_at_least(bool m, T a, T b) { return m & (a >= b); }
NGS_HD inline bool any(bool m) { return m; }
NGS_HD inline int count_lanes(bool m) { return m ? 1 : 0; }
NGS_HD inline float fma_lanes(float a, float b, float c) { return std::fma(a, b, c); }
NGS_HD inline double fma_lanes(double a, double b, double c) { return std::fma(a, b, c); }
template <class T> NGS_HD T min_lanes(T a, T b) { return b < a ? b : a; }
template <class T> NGS_HD void store_lanes(T* p, T x) { *p = x; }
template <class T> NGS_HD void load_lanes(const T* p, T& x) { x = *p; }
template <class T> NGS_HD void iota_lanes(T start, T& x) { x = start; }
template <class T> NGS_HD T sum_lanes(T x) { return x; }
template <class T> NGS_HD void sum_lanes_each(const T* x, int n, T* out) {
  for (int i = 0; i < n; ++i) out[i] = x[i];
}
template <class T> NGS_HD T folded(T x) { return x; }

/// kMagic = 1.5·2^23: adding it rounds to the nearest integer.
inline constexpr float kMagic = 12582912.f;

/// e^x for x in [-87, 0]. Cody-Waite reduction to |r| <= ln2/2 and the Taylor polynomial of degree 7: truncation
/// below r^8/8! = 5.2e-9 relative, so the error is rounding: at most 1.5 ulp (measured in tests/unit/math).
/// Returns e^r; `shifted` = kMagic + n with e^x = 2^n e^r: its low bits are n in two's complement.
template <class L>
NGS_HD L exp_nonpositive_reduced(L x, L& shifted) {
  const L kLog2e(1.44269504088896341f), kMinusLn2Hi(-0.693145751953125f), kMinusLn2Lo(-1.42860682030941723e-6f);
  shifted = fma_lanes(x, kLog2e, L(kMagic));
  const L n = shifted - L(kMagic);
  const L r = fma_lanes(n, kMinusLn2Lo, fma_lanes(n, kMinusLn2Hi, x));
  L p(1.f / 5040);
  p = fma_lanes(p, r, L(1.f / 720));
  p = fma_lanes(p, r, L(1.f / 120));
  p = fma_lanes(p, r, L(1.f / 24));
  p = fma_lanes(p, r, L(1.f / 6));
  p = fma_lanes(p, r, L(0.5f));
  p = fma_lanes(p, r, L(1.f));
  return fma_lanes(p, r, L(1.f));
}
/// Below -87 (and for NaN) e^-87; no result is subnormal, so 2^n is an addition to the exponent. Above 0: any value.
NGS_HD inline float exp_nonpositive(float x) {
  float shifted;
  const float p = exp_nonpositive_reduced(x > -87.f ? x : -87.f, shifted);
  const std::uint32_t exponent = __builtin_bit_cast(std::uint32_t, shifted) << 23;
  return __builtin_bit_cast(float, __builtin_bit_cast(std::uint32_t, p) + exponent);
}
NGS_HD inline double exp_nonpositive(double x) { return std::exp(x); }

}  // namespace ngs
