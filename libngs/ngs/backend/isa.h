#pragma once
// Which instruction set the compositing kernels use. All sets give the same bytes; only time depends on the choice.
#include <cstdint>

namespace ngs {

enum class Isa : std::uint8_t {
  kV3,  // x86-64-v3 (AVX2, FMA): what the whole program is compiled for
  kV4   // x86-64-v4 (AVX-512 F, BW, CD, DQ, VL)
};

/// Whether the processor can run `isa`.
bool cpu_has(Isa isa);
/// The best set that the processor can run and this build has code for.
Isa best_isa();

}  // namespace ngs
