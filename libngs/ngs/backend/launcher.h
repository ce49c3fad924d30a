#pragma once
// The interface between the kernels of ops/device/*_kernel.h and a device. A kernel is written once, against a
// Launcher: CudaLauncher runs it on a GPU (backend/cuda_launcher.cuh), the emulator of the tests thread by thread on
// the CPU (tests/support/host_launcher.h).
//
// clang-format off
//   launcher.parallel_for(n, kernel)       kernel(i) for i in [0, n), in any order; kernel(i) writes only what i owns
//   launcher.launch_blocks(n, kernel)      n cooperating blocks, see below
//   launcher.sort(keys, values, n, bits)   stable, ascending by the lowest `bits` of the 64-bit keys; in place
//   launcher.exclusive_scan(in, out, n)    out[i] = in[0] + ... + in[i - 1] for i <= n: n + 1 results
//   Launcher::atomic_add(float*, x)        in a kernel: adds where other threads may add too, in any order
//   launcher.upload / download / copy / fill_zero, launcher.release
//   launcher.allocate(bytes)               throws OutOfDeviceMemory
//   launcher.resident                      host arrays whose values are in device memory (backend/resident_table.h)
//
// All pointers in kernels are device pointers. Launches run in order; download waits for them. A kernel has a kName.
//
// A cooperative kernel has kThreads, a trivially copyable struct Shared (uninitialised), a struct Thread (variables of
// one thread), optionally kMinBlocks (blocks that must fit on a multiprocessor, a bound of registers) and
//   template <class Block> NGS_HD void operator()(Block& block) const
// which is a sequence of phases with a barrier after each:
//   block.phase([&](int thread, Shared&, Thread&) { ... })
//   block.any([&](int thread, Shared&, Thread&) -> bool { ... })    true for all threads if it is true for one
//   block.each([&](int thread, const Shared&, Thread&) { ... })       a phase without a barrier
//   block.ballot([&](int thread, const Shared&) -> bool { ... }, take)
//                                         take(Thread&, bits): bit i is that of thread i of its warp of 32; no barrier
// clang-format on
// Only phases access Shared and Thread. Control flow between phases is therefore the same for all threads, and no
// thread reads a value that another thread may already be changing. Within a phase no thread reads what another writes.
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "ngs/backend/resident_table.h"
#include "ngs/core/error.h"
#include "ngs/core/hd.h"

namespace ngs {

/// The error of every Launcher if it cannot allocate so many bytes.
[[noreturn]] inline void throw_out_of_device_memory(std::size_t bytes) {
  throw OutOfDeviceMemory("device memory: " + std::to_string((bytes >> 20) + 1) +
                          " MiB more are not available, expected enough for the model and its views");
}

/// Device memory, uninitialised until written: its own, freed in order with the launches, or a resident array's.
template <class Launcher, class T>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(Launcher& launcher, std::int64_t size) : launcher_(&launcher), size_(size) {
    if (size > 0) data_ = static_cast<T*>(launcher.allocate(std::size_t(size) * sizeof(T)));
  }
  /// `host` if it is resident, else a copy of it.
  DeviceBuffer(Launcher& launcher, const T* host, std::int64_t size) : DeviceBuffer(result(launcher, host, size)) {
    if (is_own_ && size > 0) launcher.upload(data_, host, bytes());
  }
  /// Memory for values that to(host) will store: `host` if it is resident, else memory of its own.
  static DeviceBuffer result(Launcher& launcher, const T* host, std::int64_t size) {
    void* const resident = launcher.resident.find(host, std::size_t(size) * sizeof(T));
    if (resident == nullptr) return DeviceBuffer(launcher, size);
    DeviceBuffer found;
    found.launcher_ = &launcher;
    found.data_ = static_cast<T*>(resident);
    found.size_ = size;
    found.is_own_ = false;
    return found;
  }
  DeviceBuffer(Launcher& launcher, const std::vector<T>& host)
      : DeviceBuffer(launcher, host.data(), std::int64_t(host.size())) {}
  ~DeviceBuffer() {
    if (is_own_ && data_ != nullptr) launcher_->release(data_);
  }
  DeviceBuffer(DeviceBuffer&& other) noexcept { swap(other); }
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    swap(other);
    return *this;
  }

  T* data() const { return data_; }
  std::int64_t size() const { return size_; }
  void zero() {
    if (size_ > 0) launcher_->fill_zero(data_, bytes());
  }
  /// Copies to host memory of `size()` values, or to the device's copy of it.
  void to(T* host) const {
    if (size_ == 0) return;
    void* const resident = launcher_->resident.find(host, bytes());
    if (resident == nullptr)
      launcher_->download(host, data_, bytes());
    else if (resident != data_)
      launcher_->copy(resident, data_, bytes());
  }
  void to(std::vector<T>& host) const {
    host.resize(std::size_t(size_));
    to(host.data());
  }

 private:
  std::size_t bytes() const { return std::size_t(size_) * sizeof(T); }
  void swap(DeviceBuffer& other) noexcept {
    std::swap(launcher_, other.launcher_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(is_own_, other.is_own_);
  }
  Launcher* launcher_ = nullptr;
  T* data_ = nullptr;
  std::int64_t size_ = 0;
  bool is_own_ = true;
};

inline constexpr int kWarpThreads = 32;

/// The number of the lowest or highest bit that is set; x is not 0.
NGS_HD inline int lowest_bit(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __ffs(int(x)) - 1;
#else
  return __builtin_ctz(x);
#endif
}
NGS_HD inline int highest_bit(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return 31 - __clz(int(x));
#else
  return 31 - __builtin_clz(x);
#endif
}

template <class T>
NGS_HD constexpr T ceil_div(T a, T b) {
  return (a + b - 1) / b;
}

/// The rows of one chunk when n rows are cut into chunks of `rows`. Groups of 32 chunks interleave their rows, so that
/// neighbouring threads read neighbouring rows (coalesced).
struct InterleavedChunk {
  std::int64_t first, step, end;
  NGS_HD InterleavedChunk(std::int64_t chunk, std::int64_t n, std::int64_t rows) {
    constexpr std::int64_t kInterleaved = 32;
    const std::int64_t before = chunk / kInterleaved * kInterleaved, others = ceil_div(n, rows) - before;
    step = others < kInterleaved ? others : kInterleaved;
    first = before * rows + (chunk - before);
    end = (before + step) * rows < n ? (before + step) * rows : n;
  }
};

/// The first of n ascending values that is >= x.
template <class T>
NGS_HD std::int64_t lower_bound_of(const T* values, std::int64_t n, T x) {
  std::int64_t first = 0;
  while (n > 0) {
    const std::int64_t half = n / 2;
    if (values[first + half] < x) {
      first += half + 1;
      n -= half + 1;
    } else
      n = half;
  }
  return first;
}

}  // namespace ngs
