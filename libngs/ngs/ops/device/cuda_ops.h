#pragma once
// The ops of a CUDA device (ops/device/device_ops.h).
#include "ngs/backend/exec.h"

namespace ngs {

/// The ops of the device that cuda_device() describes; null in builds without CUDA.
const DeviceOps* cuda_ops(DeviceSums sums = DeviceSums::kInOrder);

}  // namespace ngs
