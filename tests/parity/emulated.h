#pragma once
// All ops on the emulated device. emulated.cpp instantiates the kernels, which takes long.
#include "ngs/ops/device/launched_arrays.h"
#include "ngs/ops/device/launched_field_ops.h"
#include "ngs/ops/device/launched_loss_ops.h"
#include "ngs/ops/device/launched_splat_ops.h"
#include "support/host_launcher.h"

namespace ngs {
extern template class LaunchedSplatOps<test::HostLauncher>;
extern template class LaunchedFieldOps<test::HostLauncher>;
extern template class LaunchedLossOps<test::HostLauncher>;
extern template class LaunchedArrays<test::HostLauncher>;
}  // namespace ngs

namespace ngs::test {

struct Emulated {
  HostLauncher launcher;
  LaunchedSplatOps<HostLauncher> splat;
  LaunchedFieldOps<HostLauncher> field;
  LaunchedLossOps<HostLauncher> loss{launcher};
  LaunchedArrays<HostLauncher> arrays{launcher};
  DeviceOps ops{splat, field, loss, arrays};
  Emulated(ThreadOrder order, DeviceSums sums, bool guarded = false)
      : launcher(order, guarded), splat(launcher, sums), field(launcher, sums) {}
  Exec exec() const { return {.device = Device::kCuda, .device_ops = &ops}; }
};

}  // namespace ngs::test
