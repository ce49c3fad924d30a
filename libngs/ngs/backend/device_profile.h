#pragma once
// Kernel times on the CUDA device, for benchmarks. While measuring, every launch waits for the previous one. Defined in
// builds with CUDA.
#include <cstddef>
#include <string>
#include <vector>

namespace ngs {

struct KernelTime {
  std::string name;
  long launches = 0;
  double seconds = 0;
};

/// Starts measuring and clears earlier times.
void profile_device();
/// The times since profile_device(); stops measuring.
std::vector<KernelTime> device_times();
/// Bytes read and written per second by a copy of `bytes` within device memory: the best of ten.
double device_copy_bandwidth(std::size_t bytes);

}  // namespace ngs
