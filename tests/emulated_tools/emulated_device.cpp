// The emulated device in place of a GPU: what ops/device/cuda_ops.h and backend/device_info.h declare. Linked into the
// tools of build/tests/emulated_tools, before the library. These environment variables describe the device:
// clang-format off
//   NGS_EMULATED_FREE_MIB       its free memory [65536]
//   NGS_EMULATED_ALLOCATIONS    so many allocations succeed, and no more; default: all
//   NGS_EMULATED_TRAFFIC        file to which a process that used the device adds the line "LAUNCHES ALLOCATIONS"
// clang-format on
#include <cstdlib>
#include <fstream>

#include "ngs/backend/device_info.h"
#include "ngs/ops/device/cuda_ops.h"
#include "parity/emulated.h"

namespace ngs {
namespace {

std::int64_t number(const char* variable, std::int64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoll(text) : otherwise;
}

struct EmulatedDevice {
  test::Emulated emulated;

  explicit EmulatedDevice(DeviceSums sums) : emulated(test::ThreadOrder::kAscending, sums, true) {
    emulated.launcher.limit_allocations(number("NGS_EMULATED_ALLOCATIONS", -1));
  }
  ~EmulatedDevice() {
    const test::Traffic& traffic = emulated.launcher.traffic();
    const char* const path = std::getenv("NGS_EMULATED_TRAFFIC");
    if (path != nullptr && traffic.launches > 0)
      std::ofstream(path, std::ios::app) << traffic.launches << ' ' << traffic.allocations << '\n';
  }
};

}  // namespace

const DeviceOps* cuda_ops(DeviceSums sums) {
  static const EmulatedDevice in_order(DeviceSums::kInOrder), atomic(DeviceSums::kAtomic);
  return &(sums == DeviceSums::kAtomic ? atomic : in_order).emulated.ops;
}

DeviceInfo cuda_device() {
  return {.usable = true,
          .name = "emulated",
          .reason = {},
          .free_bytes = double(number("NGS_EMULATED_FREE_MIB", 65536)) * (1 << 20)};
}

void release_freed_device_memory() {}

}  // namespace ngs
