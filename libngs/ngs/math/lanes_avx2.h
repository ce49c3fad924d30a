#pragma once
// PackF: 8 floats in one AVX2 register, for translation units that are compiled for x86-64-v3 or above. lane_scalar.h
// documents the operations.
#include <immintrin.h>

#include <cstdint>

#include "ngs/math/lane_scalar.h"

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
  friend PackF operator/(PackF a, PackF b) { return a.v / b.v; }
  friend PackF operator-(PackF a) { return -a.v; }
  PackF& operator+=(PackF b) {
    v += b.v;
    return *this;
  }
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
inline PackMask and_at_least(PackMask m, PackF a, PackF b) { return m & (a >= b); }
inline PackMask all_lanes(PackF) { return {PackF::RawMask{-1, -1, -1, -1, -1, -1, -1, -1}}; }

template <>
struct LaneTraits<PackF> {
  using Scalar = float;
  using Folded = PackF;
  using Mask = PackMask;
  static constexpr int kLanes = PackF::kLanes;
};

inline PackF select(PackMask m, PackF a, PackF b) { return m.v ? a.v : b.v; }
inline bool any(PackMask m) { return _mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<__m256i>(m.v))) != 0; }
inline PackF fma_lanes(PackF a, PackF b, PackF c) { return PackF::Raw(_mm256_fmadd_ps(a.v, b.v, c.v)); }
/// Returns the second operand where the first is NaN.
inline PackF min_lanes(PackF a, PackF b) { return PackF::Raw(_mm256_min_ps(a.v, b.v)); }
inline PackF max_lanes(PackF a, PackF b) { return PackF::Raw(_mm256_max_ps(a.v, b.v)); }
inline PackF sqrt_lanes(PackF x) { return PackF::Raw(_mm256_sqrt_ps(x.v)); }
inline PackF floor_lanes(PackF x) { return PackF::Raw(_mm256_floor_ps(x.v)); }
inline void store_row_bits(std::uint32_t* p, PackF begin, PackF end) {
  const __m256i one = _mm256_set1_epi32(1), below = _mm256_sllv_epi32(one, _mm256_cvttps_epi32(begin.v)),
                until = _mm256_sllv_epi32(one, _mm256_cvttps_epi32(end.v));
  const __m256i bits = _mm256_andnot_si256(_mm256_sub_epi32(below, one), _mm256_sub_epi32(until, one));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), bits);
}
inline void store_lanes(float* p, PackF x) { _mm256_storeu_ps(p, x.v); }
inline void load_lanes(const float* p, PackF& x) { x.v = _mm256_loadu_ps(p); }
/// The pack in half precision: 11 significant bits, no magnitude below 2^-24.
struct HalfPack {
  __m128i v;
  HalfPack() = default;
  explicit HalfPack(PackF x) : v(_mm256_cvtps_ph(x.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)) {}
  PackF wide() const { return PackF::Raw(_mm256_cvtph_ps(v)); }
};
/// start, start + 1, ...
inline void iota_lanes(float start, PackF& x) { x.v = start + PackF::Raw{0, 1, 2, 3, 4, 5, 6, 7}; }
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
    const __m256 two =
        _mm256_add_ps(_mm256_castpd_ps(_mm256_unpacklo_pd(p, q)), _mm256_castpd_ps(_mm256_unpackhi_pd(p, q)));
    const __m256 one = _mm256_add_ps(two, _mm256_movehdup_ps(two));  // a . c . | b . d .
    alignas(32) float lane[8];
    _mm256_store_ps(lane, one);
    out[i] = lane[0];
    out[i + 1] = lane[4];
    out[i + 2] = lane[2];
    out[i + 3] = lane[6];
  }
  for (; i < n; ++i) out[i] = sum_lanes(x[i]);
}
/// Reduces a pack to 8 lanes by adding its upper half to the lower one, so that sums do not depend on its width.
inline PackF folded(PackF x) { return x; }
/// Number of true lanes.
inline int count_lanes(PackMask m) {
  return __builtin_popcount(unsigned(_mm256_movemask_ps(_mm256_castsi256_ps(reinterpret_cast<__m256i>(m.v)))));
}

/// Four doubles, for sums of many floats.
struct Pack4D {
  typedef double Raw __attribute__((vector_size(32)));
  Raw v;
  Pack4D(Raw raw) : v(raw) {}
  Pack4D(double x) : v(Raw{x, x, x, x}) {}
  friend Pack4D operator+(Pack4D a, Pack4D b) { return a.v + b.v; }
  double lane(int i) const { return v[i]; }
};
/// Lanes 0 to 3 and 4 to 7 of a pack.
inline Pack4D low_half(PackF x) { return Pack4D::Raw(_mm256_cvtps_pd(_mm256_castps256_ps128(x.v))); }
inline Pack4D high_half(PackF x) { return Pack4D::Raw(_mm256_cvtps_pd(_mm256_extractf128_ps(x.v, 1))); }

/// As exp2_where of a float, in every lane.
inline PackF exp2_where(PackMask m, PackF x) {
  const PackF shifted = x + PackF(kMagic), p = exp2_reduced(x - (shifted - PackF(kMagic)));
  const __m256i exponent = _mm256_slli_epi32(_mm256_castps_si256(shifted.v), 23);
  const __m256i power = _mm256_add_epi32(_mm256_castps_si256(p.v), exponent);
  return PackF::Raw(_mm256_castsi256_ps(_mm256_and_si256(power, reinterpret_cast<__m256i>(m.v))));
}

}  // namespace ngs
