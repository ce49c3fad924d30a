#include "ngs/backend/cuda_launcher.cuh"
#include "ngs/backend/device_info.h"

namespace ngs {
namespace {

struct Nothing {
  NGS_HD void operator()(std::int64_t) const {}
};

/// Why device 0 is unusable; empty if it is usable.
std::string obstacle() {
  int pools = 0;
  if (cudaDeviceGetAttribute(&pools, cudaDevAttrMemoryPoolsSupported, 0) != cudaSuccess || pools == 0)
    return "it has no memory pools";
  cudaFuncAttributes attributes;
  if (const cudaError_t e = cudaFuncGetAttributes(&attributes, detail::index_kernel<Nothing>); e != cudaSuccess)
    return std::string("this build has no code for it: ") + cudaGetErrorString(e);
  cudaMemPool_t pool;
  std::uint64_t keep = ~std::uint64_t(0);  // freed memory stays in the pool of the process
  if (cudaDeviceGetDefaultMemPool(&pool, 0) != cudaSuccess ||
      cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep) != cudaSuccess)
    return "its memory pool cannot be configured";
  return {};
}

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

/// Why no device was counted.
std::string absence(cudaError_t error) {
  int driver = 0;  // the newest CUDA that the driver supports; 0: no driver
  if (cudaDriverGetVersion(&driver) != cudaSuccess || driver == 0) return "no device: no NVIDIA driver is installed";
  if (error == cudaErrorInsufficientDriver)
    return "the driver supports CUDA " + version_text(driver) + ", expected " + version_text(CUDART_VERSION) +
           " or newer";
  return std::string("no device: ") + cudaGetErrorString(error);
}

}  // namespace

DeviceInfo cuda_device() {
  int count = 0;
  if (const cudaError_t e = cudaGetDeviceCount(&count); e != cudaSuccess) return {false, {}, absence(e)};
  if (count == 0) return {false, {}, "no device"};
  cudaDeviceProp properties;
  if (const cudaError_t e = cudaGetDeviceProperties(&properties, 0); e != cudaSuccess)
    return {false, {}, std::string("no device: ") + cudaGetErrorString(e)};
  const std::string why = obstacle();
  if (!why.empty()) return {false, properties.name, std::string(properties.name) + ": " + why};
  std::size_t free_bytes = 0, bytes = 0;
  if (const cudaError_t e = cudaMemGetInfo(&free_bytes, &bytes); e != cudaSuccess)
    return {false, properties.name, std::string(properties.name) + ": " + cudaGetErrorString(e)};
  return {true, properties.name, {}, double(free_bytes)};
}

void release_freed_device_memory() {
  cudaMemPool_t pool;
  if (cudaDeviceSynchronize() == cudaSuccess && cudaDeviceGetDefaultMemPool(&pool, 0) == cudaSuccess)
    cudaMemPoolTrimTo(pool, 0);
}

}  // namespace ngs
