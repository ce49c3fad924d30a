#include "ngs/ops/device/cuda_ops.cuh"
#include "ngs/ops/device/joint_step_grid.h"

namespace ngs {

std::unique_ptr<DeviceJointOps> cuda_joint_ops(DeviceSums sums) {
  return std::make_unique<GridJointOps<CudaLauncher>>(cuda_launcher(), sums);
}

}  // namespace ngs
