#pragma once
// Elementary functions in forms that are accurate at both ends of their range.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"
#include "ngs/math/elementary.h"

namespace ngs {

template <class T>
NGS_HD T min2(T a, T b) {
  return b < a ? b : a;
}
template <class T>
NGS_HD T max2(T a, T b) {
  return a < b ? b : a;
}
template <class T>
NGS_HD T clamp3(T x, T lo, T hi) {
  return x < lo ? lo : (hi < x ? hi : x);
}

/// 1 / (1 + e^-x), without overflow at either end.
template <class T>
NGS_HD T sigmoid(T x) {
  if (x >= T(0)) return T(1) / (T(1) + exp_of(-x));
  const T e = exp_of(x);
  return e / (T(1) + e);
}

/// The derivative of sigmoid, e^-|x| / (1 + e^-|x|)². The form s (1 - s) would be 0 in float for x >= 17, and a
/// saturated parameter could never recover.
template <class T>
NGS_HD T sigmoid_slope(T x) {
  const T e = exp_of(x < T(0) ? x : -x), sum = T(1) + e;
  return e / (sum * sum);
}

/// A cheap upper bound of e^x, at most 6.3 % too large, for x in [-87, 88]. Beyond and for NaN it is the bound of the
/// nearer end. It is 2^n (1 + f) instead of 2^(n + f): x / ln 2 in fixed point, read as the bits of a float.
NGS_HD inline float exp_at_least(float x) {
  constexpr float kScale = 12102203.f, kShift = 1065354000.f;  // 2^23 / ln 2, 127 · 2^23 and a little for rounding
  const float above = x > -87.f ? x : -87.f, within = above < 88.f ? above : 88.f;
  return __builtin_bit_cast(float, std::int32_t(kScale * within + kShift));
}

/// ln(1 + e^x). For large x the exponential would overflow, so x + ln(1 + e^-x) is used.
template <class T>
NGS_HD T softplus(T x) {
  return x > T(0) ? x + log1p_of(exp_of(-x)) : log1p_of(exp_of(x));
}

/// 1 - e^-x, accurate for small x.
template <class T>
NGS_HD T one_minus_exp(T x) {
  return -expm1_of(-x);
}

/// ln(p / (1 - p)).
template <class T>
NGS_HD T logit(T p) {
  return log_of(p) - log1p_of(-p);
}

}  // namespace ngs
