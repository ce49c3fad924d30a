#pragma once
// Where an op runs: the first argument of every op. There is no global device.
#include <cstdint>

#include "ngs/backend/isa.h"
#include "ngs/core/error.h"

namespace ngs {

#ifdef NGS_WITH_CUDA
inline constexpr bool kWithCuda = true;
#else
inline constexpr bool kWithCuda = false;
#endif

enum class Device : std::uint8_t { kCpu, kCuda };

struct Exec {
  Device device = Device::kCpu;
  int threads = 1;         // OpenMP threads, >= 1; never changes a result
  void* stream = nullptr;  // cudaStream_t, null on the CPU
  Isa isa = best_isa();    // of the compositing kernels; never changes a result
};

}  // namespace ngs
