#pragma once
// NeonPack: 8 floats in two NEON registers. Every aarch64 processor has them.
#include <arm_neon.h>

#include "ngs/math/lanes_pair.h"

namespace ngs {

struct NeonQuad {
  static QuadF fma(QuadF a, QuadF b, QuadF c) {
    return QuadF(vfmaq_f32(float32x4_t(c), float32x4_t(a), float32x4_t(b)));
  }
  static QuadF sqrt(QuadF x) { return QuadF(vsqrtq_f32(float32x4_t(x))); }
  static QuadF floor(QuadF x) { return QuadF(vrndmq_f32(float32x4_t(x))); }
  static void to_half(QuadF x, std::uint16_t* to) { vst1_u16(to, vreinterpret_u16_f16(vcvt_f16_f32(float32x4_t(x)))); }
  static QuadF from_half(const std::uint16_t* from) {
    return QuadF(vcvt_f32_f16(vreinterpret_f16_u16(vld1_u16(from))));
  }
};

using NeonPack = PackPair<NeonQuad>;

}  // namespace ngs
