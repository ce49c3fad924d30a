#include "ngs/backend/isa.h"

namespace ngs {
namespace {

#if defined(NGS_WITH_V3) || defined(NGS_WITH_V4)
/// F16C needs no test, and clang 16 has none: it came two years before AVX2.
bool cpu_is_v3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
}
#endif

#ifdef NGS_WITH_V4
bool cpu_is_v4() {
  return cpu_is_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}
#endif

}  // namespace

bool can_run(Isa isa) {
  if (isa == base_isa() || isa == Isa::kPortable) return true;
#ifdef NGS_WITH_V3
  if (isa == Isa::kV3) return cpu_is_v3();
#endif
#ifdef NGS_WITH_V4
  if (isa == Isa::kV4) return cpu_is_v4();
#endif
  return false;
}

Isa best_isa() {
  static const Isa best = can_run(Isa::kV4) ? Isa::kV4 : can_run(Isa::kV3) ? Isa::kV3 : base_isa();
  return best;
}

}  // namespace ngs
