// The libFuzzer program of the reader NGS_FUZZ_TARGET.
#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  for (const ngs::fuzz::Target& target : ngs::fuzz::kTargets)
    if (target.name == NGS_FUZZ_TARGET) ngs::fuzz::run(target, {data, size});
  return 0;
}
