#include "ngs/backend/isa.h"

namespace ngs {

bool cpu_has(Isa isa) {
  if (isa == Isa::kV3) return true;
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

Isa best_isa() {
#ifdef NGS_WITH_V4
  static const Isa best = cpu_has(Isa::kV4) ? Isa::kV4 : Isa::kV3;
  return best;
#else
  return Isa::kV3;
#endif
}

}  // namespace ngs
