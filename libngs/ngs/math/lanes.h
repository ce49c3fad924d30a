#pragma once
// The lane types of the compositing kernels: one lane = one pixel. The same source runs with
//
// clang-format off
//   PackF          8 floats: one AVX2 register, two NEON registers, or two vectors of the compiler
//   Pack16         16 floats in one AVX-512 register   (x86-64-v4: lanes16.h)
//   PortablePack   8 floats without intrinsics         (PackF without AVX2 and NEON; tests)
//   float, double  one lane                            (tests, references)
//   Dual<double>   one lane                            (gradient tests)
// clang-format on
//
// A lane of a pack computes bit for bit what `float` computes: same operations, explicit fma, no contraction. Sums of
// lanes have one order. Every instruction set therefore gives the same bytes. PackF is a different type for each set,
// so that code compiled for one set shares no symbol with code compiled for another.
#include "ngs/math/dual.h"
#include "ngs/math/lane_scalar.h"
#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)
#include "ngs/math/lanes_avx2.h"
#elif defined(__aarch64__)
#include "ngs/math/lanes_neon.h"
namespace ngs {
using PackF = NeonPack;
using HalfPack = HalfPair<NeonQuad>;
}  // namespace ngs
#else
#include "ngs/math/lanes_portable.h"
namespace ngs {
using PackF = PortablePack;
using HalfPack = HalfPair<PortableQuad>;
}  // namespace ngs
#endif

namespace ngs {

template <class T>
Dual<T> fma_lanes(Dual<T> a, Dual<T> b, Dual<T> c) {
  return a * b + c;
}
template <class T>
Dual<T> exp2_where(bool m, Dual<T> x) {
  return m ? exp2(x) : Dual<T>(0);
}

}  // namespace ngs
