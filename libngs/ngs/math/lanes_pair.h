#pragma once
// PackPair: 8 floats as two vectors of 4, for processors without vectors of 8. A Quad has the operations that differ
// between these:
//   fma(a, b, c)         a b + c, rounded once
//   sqrt(x), floor(x)
//   to_half(x, to)       half precision, rounded to nearest, ties to even: 4 values
//   from_half(from)
// Everything else is vector arithmetic of the compiler. lane_scalar.h documents the operations.
#include <cstdint>
#include <cstring>

#include "ngs/math/lane_scalar.h"

namespace ngs {

typedef float QuadF __attribute__((vector_size(16)));
typedef std::int32_t QuadI __attribute__((vector_size(16)));

template <class Quad>
struct PackPair {
  static constexpr int kLanes = 8;
  QuadF low, high;  // lanes 0 to 3, 4 to 7

  PackPair() = default;
  PackPair(QuadF l, QuadF h) : low(l), high(h) {}
  PackPair(float x) : low(QuadF{x, x, x, x}), high(low) {}
  friend PackPair operator+(PackPair a, PackPair b) { return {a.low + b.low, a.high + b.high}; }
  friend PackPair operator-(PackPair a, PackPair b) { return {a.low - b.low, a.high - b.high}; }
  friend PackPair operator*(PackPair a, PackPair b) { return {a.low * b.low, a.high * b.high}; }
  friend PackPair operator/(PackPair a, PackPair b) { return {a.low / b.low, a.high / b.high}; }
  friend PackPair operator-(PackPair a) { return {-a.low, -a.high}; }
  PackPair& operator+=(PackPair b) { return *this = *this + b; }
};

/// A lane-wise truth value: all bits set or none.
template <class Quad>
struct MaskPair {
  QuadI low, high;
  friend MaskPair operator&(MaskPair a, MaskPair b) { return {a.low & b.low, a.high & b.high}; }
  friend MaskPair operator|(MaskPair a, MaskPair b) { return {a.low | b.low, a.high | b.high}; }
  friend MaskPair operator!(MaskPair a) { return {~a.low, ~a.high}; }
};
template <class Q>
MaskPair<Q> operator<(PackPair<Q> a, PackPair<Q> b) {
  return {a.low < b.low, a.high < b.high};
}
template <class Q>
MaskPair<Q> operator<=(PackPair<Q> a, PackPair<Q> b) {
  return {a.low <= b.low, a.high <= b.high};
}
template <class Q>
MaskPair<Q> operator>=(PackPair<Q> a, PackPair<Q> b) {
  return {a.low >= b.low, a.high >= b.high};
}
template <class Q>
MaskPair<Q> operator>(PackPair<Q> a, PackPair<Q> b) {
  return {a.low > b.low, a.high > b.high};
}
template <class Q>
MaskPair<Q> and_at_least(MaskPair<Q> m, PackPair<Q> a, PackPair<Q> b) {
  return m & (a >= b);
}
template <class Q>
MaskPair<Q> all_lanes(PackPair<Q>) {
  const QuadI all = {-1, -1, -1, -1};
  return {all, all};
}

template <class Q>
struct LaneTraits<PackPair<Q>> {
  using Scalar = float;
  using Folded = PackPair<Q>;
  using Mask = MaskPair<Q>;
  static constexpr int kLanes = PackPair<Q>::kLanes;
};

template <class Q>
PackPair<Q> select(MaskPair<Q> m, PackPair<Q> a, PackPair<Q> b) {
  return {m.low ? a.low : b.low, m.high ? a.high : b.high};
}
inline bool any_bit(QuadI x) {
#ifdef __wasm_simd128__
  return __builtin_wasm_any_true_v128(x);
#else
  std::uint64_t part[2];
  std::memcpy(part, &x, sizeof part);
  return (part[0] | part[1]) != 0;
#endif
}
template <class Q>
bool any(MaskPair<Q> m) {
  return any_bit(m.low | m.high);
}
/// Number of true lanes.
template <class Q>
int count_lanes(MaskPair<Q> m) {
  const QuadI sum = m.low + m.high;
  return -((sum[0] + sum[2]) + (sum[1] + sum[3]));
}
template <class Q>
PackPair<Q> fma_lanes(PackPair<Q> a, PackPair<Q> b, PackPair<Q> c) {
  return {Q::fma(a.low, b.low, c.low), Q::fma(a.high, b.high, c.high)};
}
/// Returns the second operand where one is NaN or both are zero.
template <class Q>
PackPair<Q> min_lanes(PackPair<Q> a, PackPair<Q> b) {
  return select(a < b, a, b);
}
template <class Q>
PackPair<Q> max_lanes(PackPair<Q> a, PackPair<Q> b) {
  return select(a > b, a, b);
}
template <class Q>
PackPair<Q> sqrt_lanes(PackPair<Q> x) {
  return {Q::sqrt(x.low), Q::sqrt(x.high)};
}
template <class Q>
PackPair<Q> floor_lanes(PackPair<Q> x) {
  return {Q::floor(x.low), Q::floor(x.high)};
}
inline QuadI row_bits(QuadF begin, QuadF end) {
  const QuadI one = {1, 1, 1, 1};
  const auto below = [&](QuadF x) { return (one << __builtin_convertvector(x, QuadI)) - one; };
  return below(end) & ~below(begin);
}
template <class Q>
void store_row_bits(std::uint32_t* p, PackPair<Q> begin, PackPair<Q> end) {
  const QuadI low = row_bits(begin.low, end.low), high = row_bits(begin.high, end.high);
  std::memcpy(p, &low, sizeof low);
  std::memcpy(p + 4, &high, sizeof high);
}
template <class Q>
void store_lanes(float* p, PackPair<Q> x) {
  std::memcpy(p, &x.low, sizeof x.low);
  std::memcpy(p + 4, &x.high, sizeof x.high);
}
template <class Q>
void load_lanes(const float* p, PackPair<Q>& x) {
  std::memcpy(&x.low, p, sizeof x.low);
  std::memcpy(&x.high, p + 4, sizeof x.high);
}
/// The pack in half precision: 11 significant bits, no magnitude below 2^-24.
template <class Q>
struct alignas(16) HalfPair {
  std::uint16_t v[8];
  HalfPair() = default;
  explicit HalfPair(PackPair<Q> x) {
    Q::to_half(x.low, v);
    Q::to_half(x.high, v + 4);
  }
  PackPair<Q> wide() const { return {Q::from_half(v), Q::from_half(v + 4)}; }
};
/// start, start + 1, ...
template <class Q>
void iota_lanes(float start, PackPair<Q>& x) {
  x = {start + QuadF{0, 1, 2, 3}, start + QuadF{4, 5, 6, 7}};
}
/// Sum of the lanes in the fixed order ((0+4)+(2+6)) + ((1+5)+(3+7)).
template <class Q>
float sum_lanes(PackPair<Q> x) {
  const QuadF four = x.low + x.high;
  return (four[0] + four[2]) + (four[1] + four[3]);
}
/// sum_lanes of each of n packs, four at a time.
template <class Q>
void sum_lanes_each(const PackPair<Q>* x, int n, float* out) {
  const auto two = [](PackPair<Q> p, PackPair<Q> q) {
    const QuadF a = p.low + p.high, b = q.low + q.high;
    return __builtin_shufflevector(a, b, 0, 1, 4, 5) + __builtin_shufflevector(a, b, 2, 3, 6, 7);
  };
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    const QuadF ab = two(x[i], x[i + 1]), cd = two(x[i + 2], x[i + 3]);
    const QuadF one = __builtin_shufflevector(ab, cd, 0, 2, 4, 6) + __builtin_shufflevector(ab, cd, 1, 3, 5, 7);
    std::memcpy(out + i, &one, sizeof one);
  }
  for (; i < n; ++i) out[i] = sum_lanes(x[i]);
}
template <class Q>
PackPair<Q> folded(PackPair<Q> x) {
  return x;
}

/// Four doubles, for sums of many floats. Conversions take whole vectors: lane by lane, g++ 12 gives wrong values after
/// inlining for a processor without AVX (tests/unit/math/lanes_test.cpp detects it).
struct DoublePair {
  typedef double Two __attribute__((vector_size(16)));
  Two low, high;
  DoublePair(double x) : low(Two{x, x}), high(low) {}
  DoublePair(Two l, Two h) : low(l), high(h) {}
  explicit DoublePair(QuadF x)
      : low(__builtin_convertvector(__builtin_shufflevector(x, x, 0, 1), Two)),
        high(__builtin_convertvector(__builtin_shufflevector(x, x, 2, 3), Two)) {}
  QuadF narrow() const {
    typedef float TwoF __attribute__((vector_size(8)));
    return __builtin_shufflevector(__builtin_convertvector(low, TwoF), __builtin_convertvector(high, TwoF), 0, 1, 2, 3);
  }
  friend DoublePair operator+(DoublePair a, DoublePair b) { return a.low += b.low, a.high += b.high, a; }
  double lane(int i) const { return i < 2 ? low[i] : high[i - 2]; }
};
/// Lanes 0 to 3 and 4 to 7 of a pack.
template <class Q>
DoublePair low_half(PackPair<Q> x) {
  return DoublePair(x.low);
}
template <class Q>
DoublePair high_half(PackPair<Q> x) {
  return DoublePair(x.high);
}

/// As exp2_where of a float, in every lane.
template <class Q>
PackPair<Q> exp2_where(MaskPair<Q> m, PackPair<Q> x) {
  const PackPair<Q> shifted = x + PackPair<Q>(kMagic), p = exp2_reduced(x - (shifted - PackPair<Q>(kMagic)));
  const auto scaled = [](QuadF value, QuadF exponent, QuadI where) {
    return QuadF((QuadI(value) + (QuadI(exponent) << 23)) & where);
  };
  return {scaled(p.low, shifted.low, m.low), scaled(p.high, shifted.high, m.high)};
}

}  // namespace ngs
