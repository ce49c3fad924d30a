#pragma once
// Map-type kernels and memory on a CUDA device, seen from host code. Defined only in builds with the CUDA
// backend (library ngs_cuda); no tool uses it yet: `--device cuda` stays refused until whole stages run
// there.
#include "ngs/backend/exec.h"

namespace ngs {

/// kernel(i) for every i in [0, n) on the device; all pointers in the kernel are device pointers.
/// Asynchronous on exec.stream. Instantiated per kernel by NGS_CUDA_KERNEL in the op's .cu file.
template <class Kernel>
void for_each_index_cuda(const Exec& exec, std::int64_t n, const Kernel& kernel);

/// Whether a device can be used by this process.
bool device_present();

/// Device memory; kEnvironment when it runs out.
void* device_allocate(std::size_t bytes);
void device_free(void* memory);
/// Copies between host and device. Both wait for everything launched before.
void copy_to_device(void* device, const void* host, std::size_t bytes);
void copy_to_host(void* host, const void* device, std::size_t bytes);

}  // namespace ngs
