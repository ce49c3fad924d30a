#pragma once
// PortablePack: 8 floats without intrinsics, for any processor that the compiler supports.
#include <cmath>

#include "ngs/math/lanes_pair.h"

namespace ngs {

/// product + added for two doubles, rounded to odd: an inexact sum becomes the neighbouring double whose last bit is 1.
inline DoublePair::Two add_to_odd(DoublePair::Two product, DoublePair::Two added) {
  typedef std::int64_t Bits __attribute__((vector_size(16)));
  const DoublePair::Two zero = {0, 0}, sum = product + added;
  const DoublePair::Two part = sum - product, error = (product - (sum - part)) + (added - part);
  const Bits below = error < zero,
             inexact = below | (error > zero);            // both are 0 if `error` is NaN, as for an infinite sum
  const Bits even = (Bits(sum) & 1) - 1;                  // all bits, or none
  const Bits towards_error = (below ^ (sum < zero)) | 1;  // 1 away from zero, -1 towards it
  return DoublePair::Two(Bits(sum) + (inexact & even & towards_error));
}
/// Whether rounding one of the sums to float may differ from rounding the exact sum: it is in the middle between two
/// floats, or becomes a subnormal float, whose middles have other bits.
inline bool may_round_twice(DoublePair sum) {
  typedef std::uint32_t QuadU __attribute__((vector_size(16)));
  const QuadU low = QuadU(sum.low), high = QuadU(sum.high);
  const QuadU last = __builtin_shufflevector(low, high, 0, 2, 4, 6);   // bits 0 to 31 of each
  const QuadU first = __builtin_shufflevector(low, high, 1, 3, 5, 7);  // bits 32 to 63
  const QuadI in_middle = (last & 0x1fffffffu) == 0x10000000u,
              tiny = (first << 1) - 1 < (0x38100000u << 1) - 1;  // neither 0 nor 2^-126 or more
  return any_bit(in_middle | tiny);
}
__attribute__((noinline)) inline QuadF rounded_from_odd(DoublePair product, DoublePair added) {
  return DoublePair(add_to_odd(product.low, added.low), add_to_odd(product.high, added.high)).narrow();
}
/// a b + c, rounded once. The product of two floats is exact in double. Only where the sum in double may be rounded
/// twice is it rounded to odd, with 29 bits to spare, so that rounding it to float gives the same as rounding the exact
/// sum (Boldo and Melquiond 2008).
inline QuadF fma_by_double(QuadF a, QuadF b, QuadF c) {
  const DoublePair x(a), y(b), z(c), product(x.low * y.low, x.high * y.high);
  const DoublePair sum = product + z;
  if (__builtin_expect(may_round_twice(sum), false)) return rounded_from_odd(product, z);
  return sum.narrow();
}

/// Half precision by integer arithmetic. A half below 2^-14 is a multiple of 2^-24, the step of floats in [1/2, 1):
/// adding 1/2 rounds to it.
inline std::uint16_t half_bits(float x) {
  const std::uint32_t bits = __builtin_bit_cast(std::uint32_t, x), size = bits & 0x7fffffffu;
  const std::uint32_t fixed = __builtin_bit_cast(std::uint32_t, __builtin_bit_cast(float, size) + 0.5f) - 0x3f000000u;
  const std::uint32_t rounded = (size + 0xfffu + ((size >> 13) & 1u) - (112u << 23)) >> 13;
  const std::uint32_t special = size > 0x7f800000u ? 0x7e00u | ((size >> 13) & 0x3ffu) : 0x7c00u;
  const std::uint32_t half = size < 0x38800000u ? fixed : size < 0x477ff000u ? rounded : special;
  return std::uint16_t(half | (bits >> 16 & 0x8000u));
}
inline float float_of_half(std::uint16_t half) {
  const std::uint32_t sign = std::uint32_t(half & 0x8000u) << 16, size = std::uint32_t(half & 0x7fffu) << 13;
  const std::uint32_t special = size | 0x7f800000u | (size > (0x7c00u << 13) ? 0x00400000u : 0u);
  const float scaled = __builtin_bit_cast(float, size) * 0x1p112f;
  return __builtin_bit_cast(float,
                            sign | (size < (0x7c00u << 13) ? __builtin_bit_cast(std::uint32_t, scaled) : special));
}

struct PortableQuad {
  static QuadF fma(QuadF a, QuadF b, QuadF c) {
#ifdef FP_FAST_FMAF
    QuadF out;
    for (int i = 0; i < 4; ++i) out[i] = std::fma(a[i], b[i], c[i]);
    return out;
#else
    return fma_by_double(a, b, c);
#endif
  }
  static QuadF sqrt(QuadF x) {
    QuadF out;
    for (int i = 0; i < 4; ++i) out[i] = std::sqrt(x[i]);
    return out;
  }
  /// Truncates, and subtracts 1 where the truncated value exceeds x. Values without fractional bits stay; a zero keeps
  /// its sign.
  static QuadF floor(QuadF x) {
    const QuadF most = {0x1p23f, 0x1p23f, 0x1p23f, 0x1p23f}, zero = {0, 0, 0, 0}, one = {1, 1, 1, 1};
    const QuadI small = (x < most) & (x > -most), sign = QuadI(x) & QuadI(-zero);
    const QuadF whole = __builtin_convertvector(__builtin_convertvector(small ? x : zero, QuadI), QuadF);
    const QuadF below = whole - (whole > x ? one : zero);
    return small ? QuadF(QuadI(below) | sign) : x;
  }
  static void to_half(QuadF x, std::uint16_t* to) {
    for (int i = 0; i < 4; ++i) to[i] = half_bits(x[i]);
  }
  static QuadF from_half(const std::uint16_t* from) {
    QuadF out;
    for (int i = 0; i < 4; ++i) out[i] = float_of_half(from[i]);
    return out;
  }
};

using PortablePack = PackPair<PortableQuad>;

}  // namespace ngs
