#pragma once
// What the compositing kernels ask of a scalar: one lane = one pixel. The same source runs with
//   PackF     8 floats in one AVX2 register        (production)
//   float, double                                  (one lane; tests, references)
//   Dual<double>                                   (one lane; gradient tests)
// A lane of PackF computes bit for bit what `float` computes: same operations, explicit fma, no contraction.
#include <immintrin.h>

#include <cmath>
#include <cstdint>

#include "ngs/math/dual.h"

namespace ngs {

struct PackF {
  static constexpr int kLanes = 8;
  typedef float Raw __attribute__((vector_size(32)));
  typedef std::int32_t RawMask __attribute__((vector_size(32)));
  Raw v;

  PackF() = default;
  PackF(Raw raw) : v(raw) {}
  PackF(float x) : v(Raw{x, x, x, x, x, x, x, x}) {}
  friend PackF operator+(PackF a, PackF b) { return a.v + b.v; }
  friend PackF operator-(PackF a, PackF b) { return a.v - b.v; }
  friend PackF operator*(PackF a, PackF b) { return a.v * b.v; }
  friend PackF operator-(PackF a) { return -a.v; }
  PackF& operator+=(PackF b) { v += b.v; return *this; }
};

/// A lane-wise truth value: all bits set or none.
struct PackMask {
  PackF::RawMask v;
  friend PackMask operator&(PackMask a, PackMask b) { return {a.v & b.v}; }
  friend PackMask operator|(PackMask a, PackMask b) { return {a.v | b.v}; }
  friend PackMask operator!(PackMask a) { return {~a.v}; }
};
inline PackMask operator<(PackF a, PackF b) { return {a.v < b.v}; }
inline PackMask operator<=(PackF a, PackF b) { return {a.v <= b.v}; }
inline PackMask operator>=(PackF a, PackF b) { return {a.v >= b.v}; }
inline PackMask operator>(PackF a, PackF b) { return {a.v > b.v}; }

template <class L> struct LaneTraits {
  using Scalar = L;
  using Mask = bool;
  static constexpr int kLanes = 1;
};
template <> struct LaneTraits<PackF> {
  using Scalar = float;
  using Mask = PackMask;
  static constexpr int kLanes = PackF::kLanes;
};

inline PackF select(PackMask m, PackF a, PackF b) { return m.v ? a.v : b.v; }
inline bool any(PackMask m) { return _mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<__m256i>(m.v))) != 0; }
inline PackF fma_lanes(PackF a, PackF b, PackF c) { return PackF::Raw(_mm256_fmadd_ps(a.v, b.v, c.v)); }
inline PackF min_lanes(PackF a, PackF b) { return PackF::Raw(_mm256_min_ps(a.v, b.v)); }
inline void store_lanes(float* p, PackF x) { _mm256_storeu_ps(p, x.v); }
inline void load_lanes(const float* p, PackF& x) { x.v = _mm256_loadu_ps(p); }
/// start, start + 1, ...
inline void iota_lanes(float start, PackF& x) {
  x.v = start + PackF::Raw{0, 1, 2, 3, 4, 5, 6, 7};
}
/// Sum of the lanes in the fixed order ((0+4)+(2+6)) + ((1+5)+(3+7)).
inline float sum_lanes(PackF x) {
  const __m128 four = _mm_add_ps(_mm256_castps256_ps128(x.v), _mm256_extractf128_ps(x.v, 1));
  const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
}
/// Number of true lanes.
inline int count_lanes(PackMask m) {
  return __builtin_popcount(unsigned(_mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<__m256i>(m.v)))));
}

template <class T> T select(bool m, T a, T b) { return m ? a : b; }
inline bool any(bool m) { return m; }
inline int count_lanes(bool m) { return m ? 1 : 0; }
inline float fma_lanes(float a, float b, float c) { return std::fma(a, b, c); }
inline double fma_lanes(double a, double b, double c) { return std::fma(a, b, c); }
template <class T> Dual<T> fma_lanes(Dual<T> a, Dual<T> b, Dual<T> c) { return a * b + c; }
template <class T> T min_lanes(T a, T b) { return b < a ? b : a; }
template <class T> void store_lanes(T* p, T x) { *p = x; }
template <class T> void load_lanes(const T* p, T& x) { x = *p; }
template <class T> void iota_lanes(T start, T& x) { x = start; }
template <class T> T sum_lanes(T x) { return x; }

/// e^x for x in [-87, 0]. Cody-Waite reduction to |r| <= ln2/2 and the Taylor polynomial of degree 7: truncation
/// below r^8/8! = 5.2e-9 relative, so the error is rounding: at most 1.5 ulp (measured in tests/unit/math).
template <class L>
L exp_nonpositive_reduced(L x, L& n) {
  const L kLog2e(1.44269504088896341f), kLn2Hi(0.693145751953125f), kLn2Lo(1.42860682030941723e-6f);
  const L kMagic(12582912.f);  // 1.5·2^23: adding it rounds to the nearest integer
  n = fma_lanes(x, kLog2e, kMagic) - kMagic;
  const L r = fma_lanes(-n, kLn2Lo, fma_lanes(-n, kLn2Hi, x));
  L p(1.f / 5040);
  p = fma_lanes(p, r, L(1.f / 720));
  p = fma_lanes(p, r, L(1.f / 120));
  p = fma_lanes(p, r, L(1.f / 24));
  p = fma_lanes(p, r, L(1.f / 6));
  p = fma_lanes(p, r, L(0.5f));
  p = fma_lanes(p, r, L(1.f));
  return fma_lanes(p, r, L(1.f));
}
inline PackF exp_nonpositive(PackF x) {
  PackF n;
  const PackF p = exp_nonpositive_reduced(select(x < PackF(-87.f), PackF(-87.f), x), n);
  const __m256i biased = _mm256_add_epi32(_mm256_cvtps_epi32(n.v), _mm256_set1_epi32(127));
  return p * PackF(PackF::Raw(_mm256_castsi256_ps(_mm256_slli_epi32(biased, 23))));
}
inline float exp_nonpositive(float x) {
  float n;
  const float p = exp_nonpositive_reduced(x < -87.f ? -87.f : x, n);
  return p * std::ldexp(1.f, int(n));
}
inline double exp_nonpositive(double x) { return std::exp(x); }
template <class T> Dual<T> exp_nonpositive(Dual<T> x) { return exp(x); }

}  // namespace ngs
