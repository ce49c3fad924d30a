#pragma once
// What a device offers to the schedules of ops/device/*_kernel.h. A schedule is written once, against a Launcher:
// CudaLauncher runs it on a GPU (backend/cuda_launcher.cuh), the emulator of the tests thread by thread on the CPU
// (tests/support/host_launcher.h).
//
//   launcher.parallel_for(n, kernel)              kernel(i) for i in [0, n), in no order; kernel(i) writes only what i owns
//   launcher.launch_blocks(n, kernel)            n cooperating blocks, see below
//   launcher.sort(keys, values, n, bits)  stable, ascending by the lowest `bits` of the 64-bit keys; both are replaced
//   launcher.exclusive_scan(in, out, n)       out[i] = in[0] + ... + in[i - 1], i <= n: n + 1 results
//   Launcher::atomic_add(float*, x)           in a kernel: adds where other threads may add too, in no order
//   launcher.upload / download / fill_zero, launcher.allocate / release
//
// All pointers in kernels are the device's. Launches run in order; download waits for them. A kernel has a kName.
//
// A cooperative kernel has kThreads, a trivially copyable struct Shared (not initialised), a struct Thread (a thread's
// own variables) and
//   template <class Block> NGS_HD void operator()(Block& block) const
// which is a sequence of phases with a barrier after each:
//   block.phase([&](int thread, Shared&, Thread&) { ... })
//   block.any([&](int thread, Shared&, Thread&) -> bool { ... })    the same answer for all threads
// Only phases see Shared and Thread, so what decides between phases is the same for all threads, and nothing is read
// that another thread may already be changing. Within a phase no thread reads what another writes.
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "ngs/core/hd.h"

namespace ngs {

/// Owned memory of a device, contents undefined until written. Freed in order with the launches.
template <class Launcher, class T>
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(Launcher& launcher, std::int64_t size) : launcher_(&launcher), size_(size) {
    if (size > 0) data_ = static_cast<T*>(launcher.allocate(std::size_t(size) * sizeof(T)));
  }
  /// A copy of `host`.
  DeviceBuffer(Launcher& launcher, const T* host, std::int64_t size) : DeviceBuffer(launcher, size) {
    if (size > 0) launcher.upload(data_, host, std::size_t(size) * sizeof(T));
  }
  DeviceBuffer(Launcher& launcher, const std::vector<T>& host)
      : DeviceBuffer(launcher, host.data(), std::int64_t(host.size())) {}
  ~DeviceBuffer() {
    if (data_ != nullptr) launcher_->release(data_);
  }
  DeviceBuffer(DeviceBuffer&& other) noexcept { swap(other); }
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    swap(other);
    return *this;
  }

  T* data() const { return data_; }
  std::int64_t size() const { return size_; }
  void zero() {
    if (size_ > 0) launcher_->fill_zero(data_, std::size_t(size_) * sizeof(T));
  }
  /// Into host memory of `size()` values.
  void to(T* host) const {
    if (size_ > 0) launcher_->download(host, data_, std::size_t(size_) * sizeof(T));
  }
  void to(std::vector<T>& host) const {
    host.resize(std::size_t(size_));
    to(host.data());
  }

 private:
  void swap(DeviceBuffer& other) noexcept {
    std::swap(launcher_, other.launcher_), std::swap(data_, other.data_), std::swap(size_, other.size_);
  }
  Launcher* launcher_ = nullptr;
  T* data_ = nullptr;
  std::int64_t size_ = 0;
};

template <class T>
NGS_HD constexpr T ceil_div(T a, T b) {
  return (a + b - 1) / b;
}

/// The rows of chunk i where n rows are cut into chunks of `rows`: 32 chunks deal theirs out among them, so that
/// neighbouring threads read neighbouring rows.
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
    if (values[first + half] < x)
      first += half + 1, n -= half + 1;
    else
      n = half;
  }
  return first;
}

}  // namespace ngs
