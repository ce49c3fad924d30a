#pragma once
// The instruction set of the compositing kernels. All sets give the same bytes; only speed depends on the choice.
#include <cstdint>

namespace ngs {

enum class Isa : std::uint8_t {
  kPortable,  // plain C++, compiled for the processors that the whole program is compiled for
  kNeon,      // aarch64, always available there
  kV3,        // x86-64-v3 (AVX2, FMA, F16C)
  kV4         // x86-64-v4 (AVX-512 F, BW, CD, DQ, VL)
};

/// The set that the whole program is compiled for.
constexpr Isa base_isa() {
#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)
  return Isa::kV3;
#elif defined(__aarch64__)
  return Isa::kNeon;
#else
  return Isa::kPortable;
#endif
}
/// True if this build has code for `isa` and the processor can run it.
bool can_run(Isa isa);
/// The fastest set that can run.
Isa best_isa();

}  // namespace ngs
