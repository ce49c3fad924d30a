#pragma once
// The grid-stride launch behind for_each_index_cuda. Included by *.cu only.
#include <cuda_runtime.h>

#include "ngs/backend/for_each_cuda.h"

namespace ngs {
namespace detail {

template <class Kernel>
__global__ void for_each_index_kernel(std::int64_t n, Kernel kernel) {
  const std::int64_t stride = std::int64_t(blockDim.x) * gridDim.x;
  for (std::int64_t i = std::int64_t(blockIdx.x) * blockDim.x + threadIdx.x; i < n; i += stride) kernel(i);
}

}  // namespace detail

inline void check_cuda(cudaError_t status, const char* what) {
  if (status != cudaSuccess)
    throw Error(ErrorCode::kEnvironment,
                std::string(what) + ": " + cudaGetErrorString(status) + ", expected success",
                "run with --device cpu");
}

template <class Kernel>
void for_each_index_cuda(const Exec& exec, std::int64_t n, const Kernel& kernel) {
  if (n == 0) return;
  constexpr int kBlock = 256;
  constexpr std::int64_t kMostBlocks = 65535;
  const std::int64_t blocks = (n + kBlock - 1) / kBlock;
  const auto grid = static_cast<unsigned>(blocks < kMostBlocks ? blocks : kMostBlocks);
  detail::for_each_index_kernel<<<grid, kBlock, 0, static_cast<cudaStream_t>(exec.stream)>>>(n, kernel);
  check_cuda(cudaGetLastError(), Kernel::kName);
}

}  // namespace ngs

#define NGS_CUDA_KERNEL(...) \
  template void ngs::for_each_index_cuda<__VA_ARGS__>(const ngs::Exec&, std::int64_t, const __VA_ARGS__&)
