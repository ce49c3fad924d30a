#pragma once
// Pack16: 16 floats in one AVX-512 register, with the operations of lanes.h. Only for translation units that are
// compiled for x86-64-v4 and that run only if can_run(Isa::kV4) (backend/isa.h). Each lane computes bit for bit what
// PackF and `float` compute; sums go through folded(), so that no result depends on the width.
#ifdef __AVX512F__
#include "ngs/math/lanes.h"

namespace ngs {

struct Pack16 {
  static constexpr int kLanes = 16;
  typedef float Raw __attribute__((vector_size(64)));
  Raw v;

  Pack16() = default;
  Pack16(Raw raw) : v(raw) {}
  Pack16(float x) : v(Raw(_mm512_set1_ps(x))) {}
  friend Pack16 operator+(Pack16 a, Pack16 b) { return a.v + b.v; }
  friend Pack16 operator-(Pack16 a, Pack16 b) { return a.v - b.v; }
  friend Pack16 operator*(Pack16 a, Pack16 b) { return a.v * b.v; }
  friend Pack16 operator-(Pack16 a) { return -a.v; }
  Pack16& operator+=(Pack16 b) {
    v += b.v;
    return *this;
  }
};

struct Pack16Mask {
  __mmask16 v;
  friend Pack16Mask operator&(Pack16Mask a, Pack16Mask b) { return {__mmask16(a.v & b.v)}; }
  friend Pack16Mask operator|(Pack16Mask a, Pack16Mask b) { return {__mmask16(a.v | b.v)}; }
  friend Pack16Mask operator!(Pack16Mask a) { return {__mmask16(~a.v)}; }
};
inline Pack16Mask operator<(Pack16 a, Pack16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ)}; }
inline Pack16Mask operator<=(Pack16 a, Pack16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ)}; }
inline Pack16Mask operator>=(Pack16 a, Pack16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ)}; }
inline Pack16Mask operator>(Pack16 a, Pack16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ)}; }

/// m & (a >= b), as one comparison.
inline Pack16Mask and_at_least(Pack16Mask m, Pack16 a, Pack16 b) {
  return {_mm512_mask_cmp_ps_mask(m.v, a.v, b.v, _CMP_GE_OQ)};
}

template <>
struct LaneTraits<Pack16> {
  using Scalar = float;
  using Folded = PackF;
  using Mask = Pack16Mask;
  static constexpr int kLanes = Pack16::kLanes;
};

inline Pack16 select(Pack16Mask m, Pack16 a, Pack16 b) { return Pack16::Raw(_mm512_mask_blend_ps(m.v, b.v, a.v)); }
inline bool any(Pack16Mask m) { return m.v != 0; }
inline int count_lanes(Pack16Mask m) { return __builtin_popcount(unsigned(m.v)); }
inline Pack16 fma_lanes(Pack16 a, Pack16 b, Pack16 c) { return Pack16::Raw(_mm512_fmadd_ps(a.v, b.v, c.v)); }
inline Pack16 min_lanes(Pack16 a, Pack16 b) { return Pack16::Raw(_mm512_min_ps(a.v, b.v)); }
inline Pack16 max_lanes(Pack16 a, Pack16 b) { return Pack16::Raw(_mm512_max_ps(a.v, b.v)); }
inline Pack16 sqrt_lanes(Pack16 x) { return Pack16::Raw(_mm512_sqrt_ps(x.v)); }
inline Pack16 floor_lanes(Pack16 x) {
  return Pack16::Raw(_mm512_roundscale_ps(x.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
}
inline void store_row_bits(std::uint32_t* p, Pack16 begin, Pack16 end) {
  const __m512i one = _mm512_set1_epi32(1), below = _mm512_sllv_epi32(one, _mm512_cvttps_epi32(begin.v)),
                until = _mm512_sllv_epi32(one, _mm512_cvttps_epi32(end.v));
  _mm512_storeu_si512(p, _mm512_andnot_si512(_mm512_sub_epi32(below, one), _mm512_sub_epi32(until, one)));
}
inline void store_lanes(float* p, Pack16 x) { _mm512_storeu_ps(p, x.v); }
inline void load_lanes(const float* p, Pack16& x) { x.v = _mm512_loadu_ps(p); }
inline void iota_lanes(float start, Pack16& x) {
  x.v = start + Pack16::Raw{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
inline PackF folded(Pack16 x) {
  return PackF::Raw(_mm512_castps512_ps256(x.v)) + PackF::Raw(_mm512_extractf32x8_ps(x.v, 1));
}
/// out[i]: lanes 0..7 if bit i of `lower` is set, lanes 8..15 if bit i of `upper` is set, i < 16.
inline void masks_of_halves(std::uint32_t lower, std::uint32_t upper, Pack16Mask* out) {
  const std::uint32_t bytes = _pdep_u32(lower, 0x55555555u) | _pdep_u32(upper, 0xaaaaaaaau);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_movm_epi8(bytes));
}
/// As exp2_where of a float, in every lane. Only the lanes of `m` are scaled: a subnormal result would cost some
/// processors a hundred cycles.
inline Pack16 exp2_where(Pack16Mask m, Pack16 x) {
  const Pack16 n = Pack16::Raw(_mm512_roundscale_ps(x.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
  return Pack16::Raw(_mm512_maskz_scalef_ps(m.v, exp2_reduced(x - n).v, n.v));
}

}  // namespace ngs
#endif
