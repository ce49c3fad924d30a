#pragma once
// What the compositing kernels ask of a scalar: one lane = one pixel. The same source runs with
//   PackF     8 floats in one AVX2 register        (production, x86-64-v3)
//   Pack16    16 in one AVX-512 register           (production, x86-64-v4: lanes16.h)
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
  using Folded = L;
  using Mask = bool;
  static constexpr int kLanes = 1;
};
template <> struct LaneTraits<PackF> {
  using Scalar = float;
  using Folded = PackF;
  using Mask = PackMask;
  static constexpr int kLanes = PackF::kLanes;
};

inline PackF select(PackMask m, PackF a, PackF b) { return m.v ? a.v : b.v; }
inline bool any(PackMask m) { return _mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<__m256i>(m.v))) != 0; }
inline PackF fma_lanes(PackF a, PackF b, PackF c) { return PackF::Raw(_mm256_fmadd_ps(a.v, b.v, c.v)); }
inline PackF min_lanes(PackF a, PackF b) { return PackF::Raw(_mm256_min_ps(a.v, b.v)); }
inline PackF max_lanes(PackF a, PackF b) { return PackF::Raw(_mm256_max_ps(a.v, b.v)); }
inline void store_lanes(float* p, PackF x) { _mm256_storeu_ps(p, x.v); }
inline void load_lanes(const float* p, PackF& x) { x.v = _mm256_loadu_ps(p); }
/// The pack in half precision: 11 bits, and nothing below 2^-24.
struct HalfPack {
  __m128i v;
  HalfPack() = default;
  explicit HalfPack(PackF x) : v(_mm256_cvtps_ph(x.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)) {}
  PackF wide() const { return PackF::Raw(_mm256_cvtph_ps(v)); }
};
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
/// sum_lanes of each of n packs, four at a time.
inline void sum_lanes_each(const PackF* x, int n, float* out) {
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    const __m256 a = x[i].v, b = x[i + 1].v, c = x[i + 2].v, d = x[i + 3].v;
    const __m256 ab = _mm256_add_ps(_mm256_permute2f128_ps(a, b, 0x20), _mm256_permute2f128_ps(a, b, 0x31));
    const __m256 cd = _mm256_add_ps(_mm256_permute2f128_ps(c, d, 0x20), _mm256_permute2f128_ps(c, d, 0x31));
    const __m256d p = _mm256_castps_pd(ab), q = _mm256_castps_pd(cd);
    const __m256 two = _mm256_add_ps(_mm256_castpd_ps(_mm256_unpacklo_pd(p, q)), _mm256_castpd_ps(_mm256_unpackhi_pd(p, q)));
    const __m256 one = _mm256_add_ps(two, _mm256_movehdup_ps(two));  // a . c . | b . d .
    alignas(32) float lane[8];
    _mm256_store_ps(lane, one);
    out[i] = lane[0], out[i + 1] = lane[4], out[i + 2] = lane[2], out[i + 3] = lane[6];
  }
  for (; i < n; ++i) out[i] = sum_lanes(x[i]);
}
/// The part of a pack over which sums are kept once its width is to leave no trace: 8 lanes, upper half added to lower.
inline PackF folded(PackF x) { return x; }
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
template <class T> void sum_lanes_each(const T* x, int n, T* out) {
  for (int i = 0; i < n; ++i) out[i] = x[i];
}
template <class T> T folded(T x) { return x; }

/// Four doubles, for geometry that is found for several places at once.
struct Pack4D {
  typedef double Raw __attribute__((vector_size(32)));
  Raw v;
  Pack4D(Raw raw) : v(raw) {}
  Pack4D(double x) : v(Raw{x, x, x, x}) {}
  Pack4D(double a, double b, double c, double d) : v(Raw{a, b, c, d}) {}
  friend Pack4D operator+(Pack4D a, Pack4D b) { return a.v + b.v; }
  friend Pack4D operator-(Pack4D a, Pack4D b) { return a.v - b.v; }
  friend Pack4D operator*(Pack4D a, Pack4D b) { return a.v * b.v; }
};
/// The second operand where the first is NaN.
inline Pack4D min_lanes(Pack4D a, Pack4D b) { return Pack4D::Raw(_mm256_min_pd(a.v, b.v)); }
inline Pack4D max_lanes(Pack4D a, Pack4D b) { return Pack4D::Raw(_mm256_max_pd(a.v, b.v)); }
inline Pack4D sqrt_lanes(Pack4D a) { return Pack4D::Raw(_mm256_sqrt_pd(a.v)); }
inline Pack4D floor_lanes(Pack4D a) { return Pack4D::Raw(_mm256_floor_pd(a.v)); }
/// Rounds towards zero; the values must fit.
inline void store_ints(int* p, Pack4D a) { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), _mm256_cvttpd_epi32(a.v)); }

/// kMagic = 1.5·2^23: adding it rounds to the nearest integer.
inline constexpr float kMagic = 12582912.f;

/// e^x for x in [-87, 0]. Cody-Waite reduction to |r| <= ln2/2 and the Taylor polynomial of degree 7: truncation
/// below r^8/8! = 5.2e-9 relative, so the error is rounding: at most 1.5 ulp (measured in tests/unit/math).
/// Returns e^r; `shifted` = kMagic + n with e^x = 2^n e^r: its low bits are n in two's complement.
template <class L>
L exp_nonpositive_reduced(L x, L& shifted) {
  const L kLog2e(1.44269504088896341f), kLn2Hi(0.693145751953125f), kLn2Lo(1.42860682030941723e-6f);
  shifted = fma_lanes(x, kLog2e, L(kMagic));
  const L n = shifted - L(kMagic);
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
/// Below -87 (and for NaN) e^-87; no result is subnormal, so 2^n is an addition to the exponent. Above 0: any value.
inline PackF exp_nonpositive(PackF x) {
  PackF shifted;
  const PackF p = exp_nonpositive_reduced(max_lanes(x, PackF(-87.f)), shifted);
  const __m256i exponent = _mm256_slli_epi32(_mm256_castps_si256(shifted.v), 23);
  return PackF(PackF::Raw(_mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(p.v), exponent))));
}
inline float exp_nonpositive(float x) {
  float shifted;
  const float p = exp_nonpositive_reduced(x < -87.f ? -87.f : x, shifted);
  return p * std::ldexp(1.f, int(shifted - kMagic));
}
inline double exp_nonpositive(double x) { return std::exp(x); }
template <class T> Dual<T> exp_nonpositive(Dual<T> x) { return exp(x); }

}  // namespace ngs
