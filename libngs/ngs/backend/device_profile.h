#pragma once
// Times of kernels on the CUDA device, for benchmarks. Measuring makes every launch wait for the one before. Defined in
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

/// Begins to measure, forgetting what was measured.
void profile_device();
/// What was measured since; ends measuring.
std::vector<KernelTime> device_times();
/// Bytes read and written per second by a copy of `bytes` within device memory: the best of ten.
double device_copy_bandwidth(std::size_t bytes);

}  // namespace ngs
