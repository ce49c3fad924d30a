#pragma once
// The Launcher of backend/launcher.h on a CUDA device. Included by *.cu only. All work of a process goes to one stream
// that does not synchronise with other streams.
#include <cuda_runtime.h>

#include "ngs/backend/launcher.h"
#include "ngs/core/error.h"

namespace ngs {

inline void check_cuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  throw Error(ErrorCode::kEnvironment,
              std::string("CUDA, ") + what + ": " + cudaGetErrorString(status) + ", expected success",
              "run with --device cpu");
}

/// A block, seen by one of its threads.
template <class Kernel>
struct CudaBlock {
  std::int64_t index;
  typename Kernel::Shared& shared;
  typename Kernel::Thread& own;

  template <class F>
  NGS_HD void phase(const F& f) {
#ifdef __CUDA_ARCH__
    f(int(threadIdx.x), shared, own);
    __syncthreads();
#endif
  }
  template <class F>
  NGS_HD bool any(const F& f) {
#ifdef __CUDA_ARCH__
    return __syncthreads_or(f(int(threadIdx.x), shared, own)) != 0;
#else
    return false;
#endif
  }
  template <class F>
  NGS_HD void each(const F& f) {
#ifdef __CUDA_ARCH__
    f(int(threadIdx.x), static_cast<const typename Kernel::Shared&>(shared), own);
#endif
  }
  template <class Test, class Take>
  NGS_HD void ballot(const Test& test, const Take& take) {
    static_assert(Kernel::kThreads % kWarpThreads == 0);
#ifdef __CUDA_ARCH__
    take(own, __ballot_sync(0xffffffffu, test(int(threadIdx.x), static_cast<const typename Kernel::Shared&>(shared))));
#endif
  }
};

namespace detail {

template <class Kernel>
__global__ void index_kernel(std::int64_t n, const __grid_constant__ Kernel kernel) {
  const std::int64_t stride = std::int64_t(blockDim.x) * gridDim.x;
  for (std::int64_t i = std::int64_t(blockIdx.x) * blockDim.x + threadIdx.x; i < n; i += stride) kernel(i);
}

/// Blocks that must fit on a multiprocessor, which limits registers: Kernel::kMinBlocks, or 1.
template <class Kernel>
constexpr int min_blocks() {
  if constexpr (requires { Kernel::kMinBlocks; }) return Kernel::kMinBlocks;
  return 1;
}

template <class Kernel>
__global__ __launch_bounds__(Kernel::kThreads,
                             min_blocks<Kernel>()) void block_kernel(std::int64_t first,
                                                                     const __grid_constant__ Kernel kernel) {
  __shared__ typename Kernel::Shared shared;
  typename Kernel::Thread own;
  CudaBlock<Kernel> block{first + blockIdx.x, shared, own};
  kernel(block);
}

/// Measures a launch while profile_device() is on (device_profile.cu).
class KernelClock {
 public:
  KernelClock(const char* name, cudaStream_t stream);
  void stop();

 private:
  const char* name_;
  cudaStream_t stream_;
  cudaEvent_t begin_ = nullptr;
};

}  // namespace detail

class CudaLauncher {
 public:
  static constexpr bool kSpoilsHost = false;  // the host's values of resident arrays
  ResidentTable resident;

  static NGS_HD void atomic_add(float* to, float x) {
#ifdef __CUDA_ARCH__
    atomicAdd(to, x);
#else
    *to += x;
#endif
  }

  template <class Kernel>
  void parallel_for(std::int64_t n, const Kernel& kernel) {
    if (n <= 0) return;
    constexpr int kBlock = 256;
    constexpr std::int64_t kMaxBlocks = std::int64_t(1) << 20;
    const std::int64_t blocks = ceil_div<std::int64_t>(n, kBlock);
    detail::KernelClock clock(Kernel::kName, stream());
    detail::index_kernel<<<unsigned(blocks < kMaxBlocks ? blocks : kMaxBlocks), kBlock, 0, stream()>>>(n, kernel);
    check_cuda(cudaGetLastError(), Kernel::kName);
    clock.stop();
    last_kernel_ = Kernel::kName;
  }

  template <class Kernel>
  void launch_blocks(std::int64_t n, const Kernel& kernel) {
    static_assert(sizeof(typename Kernel::Shared) <= 48 * 1024, "more shared memory needs an opt-in attribute");
    constexpr std::int64_t kMaxLaunched = 0x7fffffff;
    for (std::int64_t first = 0; first < n; first += kMaxLaunched) {
      const std::int64_t count = n - first < kMaxLaunched ? n - first : kMaxLaunched;
      detail::KernelClock clock(Kernel::kName, stream());
      detail::block_kernel<<<unsigned(count), Kernel::kThreads, 0, stream()>>>(first, kernel);
      check_cuda(cudaGetLastError(), Kernel::kName);
      clock.stop();
      last_kernel_ = Kernel::kName;
    }
  }

  // With CUB, whose headers compile for long (cuda_sort.cu).
  void sort(std::uint64_t* keys, std::uint32_t* values, std::int64_t n, int bits);
  void exclusive_scan(const std::uint32_t* in, std::int64_t* out, std::int64_t n);

  void* allocate(std::size_t bytes) {
    void* memory = nullptr;
    const cudaError_t status = cudaMallocAsync(&memory, bytes, stream());
    if (status == cudaErrorMemoryAllocation) {
      cudaGetLastError();  // clears it
      throw_out_of_device_memory(bytes);
    }
    check_cuda(status, "memory");
    return memory;
  }
  void release(void* memory) noexcept { cudaFreeAsync(memory, stream()); }
  void upload(void* device, const void* host, std::size_t bytes) {
    check_cuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream()), "copy to the device");
  }
  void download(void* host, const void* device, std::size_t bytes) {
    check_cuda(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream()), "copy from the device");
    // A fault of a kernel surfaces here: in the last kernel or in an earlier one.
    check_cuda(cudaStreamSynchronize(stream()), (std::string("kernels up to ") + last_kernel_).c_str());
  }
  void copy(void* to, const void* from, std::size_t bytes) {
    check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream()), "copy");
  }
  void fill_zero(void* device, std::size_t bytes) { check_cuda(cudaMemsetAsync(device, 0, bytes, stream()), "fill"); }

 private:
  const char* last_kernel_ = "none";
  /// The pool keeps freed memory, so that later allocations do not reach the operating system.
  static void keep_freed_memory() {
    int device = 0;
    cudaMemPool_t pool = nullptr;
    std::uint64_t threshold = ~std::uint64_t(0);
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetDefaultMemPool(&pool, device), "memory pool");
    check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &threshold), "memory pool");
  }
  static cudaStream_t stream() {
    static const cudaStream_t only = [] {
      cudaStream_t created = nullptr;
      check_cuda(cudaStreamCreateWithFlags(&created, cudaStreamNonBlocking), "stream");
      keep_freed_memory();
      return created;
    }();
    return only;
  }
};

}  // namespace ngs
