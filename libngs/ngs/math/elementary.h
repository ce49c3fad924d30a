#pragma once
// exp, log, log1p and expm1 of a float, and hypot. In the C library their last bit depends on the system, the processor
// and the library's version. These functions give the bits of glibc 2.36 on x86-64 wherever they are compiled, on a
// device too. In glibc, the other functions that ngs uses are equal on all processors with fused multiply-add.
//
// exp and log share coefficients and tables with Arm's optimized routines (MIT licence):
//   Copyright (c) 2017-2018, Arm Limited.
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

/// The bits of 2^(i / 32), less i · 2^47: with k · 2^47 added for k = 32 n + i they are those of 2^(k / 32).
NGS_HD inline std::uint64_t power_bits(std::uint64_t i) {
  constexpr std::uint64_t kBits[32] = {0x3ff0000000000000, 0x3fefd9b0d3158574, 0x3fefb5586cf9890f, 0x3fef9301d0125b51,
                                       0x3fef72b83c7d517b, 0x3fef54873168b9aa, 0x3fef387a6e756238, 0x3fef1e9df51fdee1,
                                       0x3fef06fe0a31b715, 0x3feef1a7373aa9cb, 0x3feedea64c123422, 0x3feece086061892d,
                                       0x3feebfdad5362a27, 0x3feeb42b569d4f82, 0x3feeab07dd485429, 0x3feea47eb03a5585,
                                       0x3feea09e667f3bcd, 0x3fee9f75e8ec5f74, 0x3feea11473eb0187, 0x3feea589994cce13,
                                       0x3feeace5422aa0db, 0x3feeb737b0cdc5e5, 0x3feec49182a3f090, 0x3feed503b23e255d,
                                       0x3feee89f995ad3ad, 0x3feeff76f2fb5e47, 0x3fef199bdd85529c, 0x3fef3720dcef9069,
                                       0x3fef5818dcfba487, 0x3fef7c97337b9b5f, 0x3fefa4afa2a490da, 0x3fefd0765b6e4540};
  return kBits[i];
}

/// ln z = log + ln(1 + r) with r = z · inverse - 1, for z in the i-th of 16 parts of [0.6992, 1.3984).
struct LogPart {
  double inverse, log;
};
NGS_HD inline LogPart log_part(std::uint32_t i) {
  constexpr LogPart kParts[16] = {
      {0x1.661ec79f8f3bep+0, -0x1.57bf7808caadep-2}, {0x1.571ed4aaf883dp+0, -0x1.2bef0a7c06ddbp-2},
      {0x1.49539f0f010bp+0, -0x1.01eae7f513a67p-2},  {0x1.3c995b0b80385p+0, -0x1.b31d8a68224e9p-3},
      {0x1.30d190c8864a5p+0, -0x1.6574f0ac07758p-3}, {0x1.25e227b0b8eap+0, -0x1.1aa2bc79c81p-3},
      {0x1.1bb4a4a1a343fp+0, -0x1.a4e76ce8c0e5ep-4}, {0x1.12358f08ae5bap+0, -0x1.1973c5a611cccp-4},
      {0x1.0953f419900a7p+0, -0x1.252f438e10c1ep-5}, {0x1p+0, 0x0p+0},
      {0x1.e608cfd9a47acp-1, 0x1.aa5aa5df25984p-5},  {0x1.ca4b31f026aap-1, 0x1.c5e53aa362eb4p-4},
      {0x1.b2036576afce6p-1, 0x1.526e57720db08p-3},  {0x1.9c2d163a1aa2dp-1, 0x1.bc2860d22477p-3},
      {0x1.886e6037841edp-1, 0x1.1058bc8a07ee1p-2},  {0x1.767dcf5534862p-1, 0x1.4043057b6ee09p-2}};
  return kParts[i];
}

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

/// e^x; 0 below -103.98, +Inf above 88.72. Half an ulp and 0.002 at most.
NGS_HD inline float portable_exp(float x) {
  using std::fma;
  if (!(x >= -0x1.9fe368p6f)) return x != x ? x : 0.f;
  if (x > 0x1.62e42ep6f) return INFINITY;
  constexpr double kPerOctave = 32, kScale = 0x1.71547652b82fep+0 * kPerOctave, kRound = 0x1.8p52;  // 32 / ln 2
  const double shifted = fma(kScale, double(x), kRound);
  const std::uint64_t k = __builtin_bit_cast(std::uint64_t, shifted);
  const double r = fma(kScale, double(x), -(shifted - kRound));  // x = (k + r) ln 2 / 32, |r| <= 1/2
  const double power = __builtin_bit_cast(double, detail::power_bits(k % 32) + (k << 47));
  constexpr double kThird = 0x1.c6af84b912394p-5 / (kPerOctave * kPerOctave * kPerOctave),
                   kSecond = 0x1.ebfce50fac4f3p-3 / (kPerOctave * kPerOctave),
                   kFirst = 0x1.62e42ff0c52d6p-1 / kPerOctave;
  return float(fma(fma(kThird, r, kSecond), r * r, fma(kFirst, r, 1.0)) * power);
}

/// ln x; -Inf for 0, NaN below. At most 0.818 ulp.
NGS_HD inline float portable_log(float x) {
  using std::fma;
  std::uint32_t bits = detail::float_bits(x);
  if (!(x >= 0x1p-126f && x < INFINITY)) {
    if (!(x > 0.f)) return x == 0.f ? -INFINITY : NAN;
    if (x == INFINITY) return x;
    bits = detail::float_bits(x * 0x1p23f) - (23u << 23);  // subnormal
  }
  const std::uint32_t above = bits - 0x3f330000u;  // x = 2^k z with z in [0.6992, 1.3984)
  const double k = double(std::int32_t(above) >> 23), z = double(detail::bits_float(bits - (above & 0xff800000u)));
  const detail::LogPart part = detail::log_part((above >> 19) % 16);
  const double r = fma(z, part.inverse, -1.0), square = r * r;
  const double rest = fma(-0x1.00ea348b88334p-2, square, fma(0x1.5575b0be00b6ap-2, r, -0x1.ffffef20a4123p-2));
  return float(fma(rest, square, fma(k, 0x1.62e42fefa39efp-1, part.log) + r));
}

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
NGS_HD T exp_of(T x) {
  using std::exp;
  return exp(x);
}
template <class T>
NGS_HD T log_of(T x) {
  using std::log;
  return log(x);
}
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
#if defined(__FMA__) || defined(__ARM_FEATURE_FMA) || defined(__CUDA_ARCH__)
NGS_HD inline float exp_of(float x) { return portable_exp(x); }
NGS_HD inline float log_of(float x) { return portable_log(x); }
#endif  // without an instruction for fused products glibc's functions are faster, and give the same bits
NGS_HD inline float log1p_of(float x) { return portable_log1p(x); }
NGS_HD inline float expm1_of(float x) { return portable_expm1(x); }

/// √(x² + y²) without intermediate overflow or underflow.
NGS_HD inline double portable_hypot(double x, double y) {
  x = std::fabs(x);
  y = std::fabs(y);
  constexpr double kInf = double(INFINITY), kScale = 0x1p-600;
  if (x == kInf || y == kInf) return kInf;
  const double longer = x < y ? y : x, shorter = x < y ? x : y;
  if (!(shorter > longer * 0x1p-54)) return longer + shorter;
  if (longer > 0x1p511) return detail::hypot_in_range(longer * kScale, shorter * kScale) / kScale;
  if (shorter < 0x1p-459) return detail::hypot_in_range(longer / kScale, shorter / kScale) * kScale;
  return detail::hypot_in_range(longer, shorter);
}

}  // namespace ngs
