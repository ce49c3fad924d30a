// Exits with 77 (skipped) without a device.
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdio>

#include "ngs/backend/device_info.h"
#include "ngs/ops/device/cuda_ops.h"
#include "parity/backends.h"

namespace ngs::test {

const std::vector<Backend>& backends() {
  static const std::vector<Backend> all{{cuda_device().name, Exec{.device = Device::kCuda, .device_ops = cuda_ops()}}};
  return all;
}
const std::vector<Backend>& atomic_backends() {
  static const std::vector<Backend> all{{cuda_device().name + ", atomic sums",
                                         Exec{.device = Device::kCuda, .device_ops = cuda_ops(DeviceSums::kAtomic)}}};
  return all;
}

}  // namespace ngs::test

int main(int argc, char** argv) {
  if (const ngs::DeviceInfo device = ngs::cuda_device(); !device.usable) {
    std::printf("skipped: %s\n", device.reason.c_str());
    return 77;
  }
  return doctest::Context(argc, argv).run();
}
