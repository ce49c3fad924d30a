#pragma once
// Where an op runs: the first argument of every op. There is no global device.
#include <cstdint>

#include "ngs/backend/isa.h"
#include "ngs/core/error.h"

namespace ngs {

enum class Device : std::uint8_t { kCpu, kCuda };

/// How a device sums the contributions of several blocks to one value: in a fixed order, always with the same bits, or
/// with atomic adds in any order.
enum class DeviceSums : std::uint8_t { kInOrder, kAtomic };

/// The ops of a device (ops/device/device_ops.h).
struct DeviceOps;

struct Exec {
  Device device = Device::kCpu;
  int threads = 1;                        // OpenMP threads, >= 1; never changes a result
  Isa isa = best_isa();                   // of the compositing kernels; never changes a result
  const DeviceOps* device_ops = nullptr;  // runs the ops that have a device path; null: the CPU runs all

  /// The same with one thread, for the tasks of a parallel loop.
  Exec one_thread() const {
    Exec same = *this;
    same.threads = 1;
    return same;
  }
  /// The same without the device.
  Exec on_cpu() const { return {.device = Device::kCpu, .threads = threads, .isa = isa, .device_ops = nullptr}; }
};

}  // namespace ngs
