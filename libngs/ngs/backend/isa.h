#pragma once
// Which instruction set the compositing kernels use. All sets give the same bytes; only time depends on the choice.
#include <cstdint>

namespace ngs {

enum class Isa : std::uint8_t {
  kPortable,  // whatever the compiler makes of plain C++ for the processors that the whole program is compiled for
  kNeon,      // aarch64, all of which has it
  kV3,        // x86-64-v3 (AVX2, FMA, F16C)
  kV4         // x86-64-v4 (AVX-512 F, BW, CD, DQ, VL)
};

/// What the whole program is compiled for.
constexpr Isa base_isa() {
#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)
  return Isa::kV3;
#elif defined(__aarch64__)
  return Isa::kNeon;
#else
  return Isa::kPortable;
#endif
}
/// Whether this build has code for `isa` and the processor can run it.
bool can_run(Isa isa);
/// The best set that can run.
Isa best_isa();

}  // namespace ngs
