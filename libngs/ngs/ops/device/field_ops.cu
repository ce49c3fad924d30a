#include "ngs/ops/device/cuda_op_groups.cuh"
#include "ngs/ops/device/launched_field_ops.h"

namespace ngs {

std::unique_ptr<DeviceFieldOps> cuda_field_ops(DeviceSums sums) {
  return std::make_unique<LaunchedFieldOps<CudaLauncher>>(cuda_launcher(), sums);
}

}  // namespace ngs
