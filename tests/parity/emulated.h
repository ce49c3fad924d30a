#pragma once
// All ops on the emulated device.
#include "ngs/ops/device/launched_arrays.h"
#include "ngs/ops/device/launched_field_ops.h"
#include "ngs/ops/device/launched_loss_ops.h"
#include "ngs/ops/device/launched_splat_ops.h"
#include "support/host_launcher.h"

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
