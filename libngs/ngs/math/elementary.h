#pragma once
// log1p and expm1 of a float, and hypot. In the C library their last bit depends on the processor and on the library's
// version. These functions give the bits of glibc 2.36 on x86-64 wherever they are compiled. In glibc, the other
// functions that ngs uses are equal on all processors with fused multiply-add.
//
// log1p and expm1 are those of fdlibm, whose coefficients they share:
//   Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved. Developed at SunPro, a Sun Microsystems, Inc.
//   business. Permission to use, copy, modify, and distribute this software is freely granted, provided that this
//   notice is preserved.
#include <cmath>
#include <cstdint>

#include "ngs/core/hd.h"

namespace ngs {
namespace detail {

inline constexpr float kLn2High = 6.9313812256e-01f, kLn2Low = 9.0580006145e-06f;  // ln 2; k · high is exact

NGS_HD inline std::uint32_t float_bits(float x) { return __builtin_bit_cast(std::uint32_t, x); }
NGS_HD inline float bits_float(std::uint32_t x) { return __builtin_bit_cast(float, x); }

/// 1 + x = 2^k (1 + f) with 1 + f in [√½, √2). `lost`: the rounding error of 1 + x, relative to 1 + x.
struct Log1pArgument {
  int k = 0;
  float f, lost = 0;
  bool tiny = false;  // |f| < 2^-20
};
NGS_HD inline Log1pArgument log1p_argument(float x) {
  if (x >= -0x1.2bec3ep-2f && x < 0x1.a827aep-2f) return {0, x};
  const float sum = x < 0x1p53f ? 1.f + x : x;
  Log1pArgument a{int(float_bits(sum) >> 23) - 127, 0};
  if (x < 0x1p53f) a.lost = (a.k > 0 ? 1.f - (sum - x) : x - (sum - 1.f)) / sum;
  const std::uint32_t fraction = float_bits(sum) & 0x007fffffu;
  if (fraction < 0x003504f7u) {
    a.f = bits_float(fraction | 0x3f800000u) - 1.f;
    a.tiny = fraction == 0;
  } else {
    ++a.k;
    a.f = bits_float(fraction | 0x3f000000u) - 1.f;
    a.tiny = (0x00800000u - fraction) >> 2 == 0;
  }
  return a;
}

/// e^x - 1 = x + half - x · rest on [-ln 2 / 2, ln 2 / 2], with half = x²/2.
struct Expm1Terms {
  float half, rest;
};
NGS_HD inline Expm1Terms expm1_terms(float x) {
  const float half_x = 0.5f * x, half = x * half_x;
  const float series =
      1.f + half * (-3.3333335072e-02f +
                    half * (1.5873016091e-03f +
                            half * (-7.9365076090e-05f + half * (4.0082177293e-06f + half * -2.0109921195e-07f))));
  const float t = 3.f - series * half_x;
  return {half, half * ((series - t) / (6.f - x * t))};
}

/// √(x² + y²) for 0 < y <= x whose squares neither overflow nor underflow. A first-order correction removes the root's
/// error (Borges 2019), without a fused product.
NGS_HD inline double hypot_in_range(double x, double y) {
  const double root = std::sqrt(x * x + y * y);
  if (root <= 2 * y) {
    const double over = root - y;
    return root - (x * (2 * over - x) + (over - 2 * (x - y)) * over) / (2 * root);
  }
  const double over = root - x;
  return root - (2 * over * (x - 2 * y) + ((4 * over - y) * y + over * over)) / (2 * root);
}

}  // namespace detail

/// ln(1 + x); -Inf for -1, NaN below.
NGS_HD inline float portable_log1p(float x) {
  using detail::kLn2High;
  using detail::kLn2Low;
  constexpr float kInf = INFINITY;
  if (!(x > -1.f)) return x == -1.f ? -kInf : NAN;
  const float size = x < 0 ? -x : x;
  if (size < 0x1p-29f) return size < 0x1p-54f ? x : x - x * x * 0.5f;
  if (x == kInf) return x;
  const detail::Log1pArgument a = detail::log1p_argument(x);
  const float k = float(a.k), f = a.f, half = 0.5f * f * f;
  if (a.tiny) {
    if (f == 0.f) return k * kLn2High + (a.lost + k * kLn2Low);
    const float rest = half * (1.f - 0.66666666666666666f * f);
    return k * kLn2High - ((rest - (k * kLn2Low + a.lost)) - f);
  }
  const float s = f / (2.f + f), z = s * s;
  const float series =
      z *
      (6.6666668653e-01f +
       z * (4.0000000596e-01f +
            z * (2.8571429849e-01f +
                 z * (2.2222198546e-01f + z * (1.8183572590e-01f + z * (1.5313838422e-01f + z * 1.4798198640e-01f))))));
  if (a.k == 0) return f - (half - s * (half + series));
  return k * kLn2High - ((half - (s * (half + series) + (k * kLn2Low + a.lost))) - f);
}

/// e^x - 1.
NGS_HD inline float portable_expm1(float x) {
  using detail::bits_float;
  using detail::float_bits;
  const float size = x < 0 ? -x : x;
  if (x != x || size < 0x1p-25f) return x;
  if (x >= 0x1.62e43p6f) return INFINITY;
  if (x <= -18.714973449707031f) return -1.f;  // 27 ln 2
  if (size <= 0.34657359f) {
    const detail::Expm1Terms e = detail::expm1_terms(x);
    return x - (x * e.rest - e.half);
  }
  const int k = size < 1.0397207f ? (x < 0 ? -1 : 1) : int(1.4426950216e+00f * x + (x < 0 ? -0.5f : 0.5f));
  const float high = x - float(k) * detail::kLn2High, low = float(k) * detail::kLn2Low;
  const float r = high - low, lost = (high - r) - low;
  const detail::Expm1Terms e = detail::expm1_terms(r);
  const float rest = (r * (e.rest - lost) - lost) - e.half;  // e^r - 1 = r - rest
  if (k == -1) return 0.5f * (r - rest) - 0.5f;
  if (k == 1) return r < -0.25f ? -2.f * (rest - (r + 0.5f)) : 1.f + 2.f * (r - rest);
  const auto scaled = [k](float y) { return bits_float(float_bits(y) + (std::uint32_t(k) << 23)); };
  if (k <= -2 || k > 56) return scaled(1.f - (rest - r)) - 1.f;
  const float power = bits_float(std::uint32_t(127 - k) << 23);  // 2^-k
  return k < 23 ? scaled((1.f - power) - (rest - r)) : scaled((r - (rest + power)) + 1.f);
}

/// For any scalar type: the functions above for float, the overloads of the type for others.
template <class T>
NGS_HD T log1p_of(T x) {
  using std::log1p;
  return log1p(x);
}
template <class T>
NGS_HD T expm1_of(T x) {
  using std::expm1;
  return expm1(x);
}
NGS_HD inline float log1p_of(float x) { return portable_log1p(x); }
NGS_HD inline float expm1_of(float x) { return portable_expm1(x); }

/// √(x² + y²) without intermediate overflow or underflow.
NGS_HD inline double portable_hypot(double x, double y) {
  x = std::fabs(x), y = std::fabs(y);
  constexpr double kInf = double(INFINITY), kScale = 0x1p-600;
  if (x == kInf || y == kInf) return kInf;
  const double longer = x < y ? y : x, shorter = x < y ? x : y;
  if (!(shorter > longer * 0x1p-54)) return longer + shorter;
  if (longer > 0x1p511) return detail::hypot_in_range(longer * kScale, shorter * kScale) / kScale;
  if (shorter < 0x1p-459) return detail::hypot_in_range(longer / kScale, shorter / kScale) * kScale;
  return detail::hypot_in_range(longer, shorter);
}

}  // namespace ngs
