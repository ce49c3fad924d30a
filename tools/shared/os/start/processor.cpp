// A program built for x86-64-v3 would crash with an illegal instruction on an older processor. This file is compiled
// for any x86-64 (tools/CMakeLists.txt) and checks the processor before anything else runs.
#ifdef __x86_64__
#include <unistd.h>

#include <cstdlib>

namespace {

[[gnu::constructor(101)]] void look_for_avx2() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) return;
  constexpr char kMessage[] =
      "error: this processor has no AVX2 and FMA, which this build of ngs requires\nhint: build it for any x86-64: "
      "NGS_PRESET=portable pipelines/build.sh\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(8);
}

}  // namespace
#endif
