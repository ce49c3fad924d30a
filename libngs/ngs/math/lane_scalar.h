#pragma once
// The lane operations of the compositing kernels for plain scalars: one lane = one pixel. The packs of math/lanes.h
// have the same operations; a thread of a device is such a scalar lane.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"

namespace ngs {

template <class L>
struct LaneTraits {
  using Scalar = L;
  using Folded = L;
  using Mask = bool;
  static constexpr int kLanes = 1;
};

template <class T>
NGS_HD T select(bool m, T a, T b) {
  return m ? a : b;
}
template <class T>
NGS_HD bool and_at_least(bool m, T a, T b) {
  return m & (a >= b);
}
template <class T>
NGS_HD bool all_lanes(T) {
  return true;
}
NGS_HD inline bool any(bool m) { return m; }
NGS_HD inline int count_lanes(bool m) { return m ? 1 : 0; }
NGS_HD inline float fma_lanes(float a, float b, float c) { return std::fma(a, b, c); }
NGS_HD inline double fma_lanes(double a, double b, double c) { return std::fma(a, b, c); }
template <class T>
NGS_HD T min_lanes(T a, T b) {
  return b < a ? b : a;
}
template <class T>
NGS_HD T max_lanes(T a, T b) {
  return a > b ? a : b;
}
template <class T>
NGS_HD T sqrt_lanes(T x) {
  return std::sqrt(x);
}
template <class T>
NGS_HD T floor_lanes(T x) {
  return std::floor(x);
}
/// Per lane: a word with bits [begin, end) set, none if end <= begin. Both are whole numbers in [0, 31].
template <class T>
NGS_HD void store_row_bits(std::uint32_t* p, T begin, T end) {
  *p = ((1u << int(end)) - 1) & ~((1u << int(begin)) - 1);
}
template <class T>
NGS_HD void store_lanes(T* p, T x) {
  *p = x;
}
template <class T>
NGS_HD void load_lanes(const T* p, T& x) {
  x = *p;
}
template <class T>
NGS_HD void iota_lanes(T start, T& x) {
  x = start;
}
template <class T>
NGS_HD T sum_lanes(T x) {
  return x;
}
template <class T>
NGS_HD void sum_lanes_each(const T* x, int n, T* out) {
  for (int i = 0; i < n; ++i) out[i] = x[i];
}
template <class T>
NGS_HD T folded(T x) {
  return x;
}

/// kMagic = 1.5·2^23: adding it rounds to the nearest integer.
inline constexpr float kMagic = 12582912.f;

/// 2^r for r in [-1/2, 1/2]: the polynomial of degree 6 with the least relative error among those that are 1 at 0
/// (3.0e-9 as rounded to float), so the error is rounding: at most 0.8 ulp (measured in tests/unit/math).
template <class L>
NGS_HD L exp2_reduced(L r) {
  L p(1.5326471e-4f);
  p = fma_lanes(p, r, L(1.3390806e-3f));
  p = fma_lanes(p, r, L(9.618506e-3f));
  p = fma_lanes(p, r, L(5.55036e-2f));
  p = fma_lanes(p, r, L(2.4022648e-1f));
  p = fma_lanes(p, r, L(6.931472e-1f));
  return fma_lanes(p, r, L(1.f));
}
/// 2^x in the lanes of `m`, 0 in the others. In the lanes of `m`, x must be in [-126, 0]; in the others it may have any
/// value. 2^x = 2^n 2^r with n the nearest integer. No result is subnormal, so the factor 2^n is an addition
/// to the exponent.
NGS_HD inline float exp2_where(bool m, float x) {
  const float shifted = x + kMagic;
  const std::uint32_t exponent = __builtin_bit_cast(std::uint32_t, shifted) << 23;
  return m ? __builtin_bit_cast(float,
                                __builtin_bit_cast(std::uint32_t, exp2_reduced(x - (shifted - kMagic))) + exponent)
           : 0.f;
}
NGS_HD inline double exp2_where(bool m, double x) { return m ? std::exp2(x) : 0.0; }

}  // namespace ngs
