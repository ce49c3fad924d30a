#include "ngs/ops/cuda_ops.cuh"
#include "ngs/ops/joint_step_grid.h"

namespace ngs {

std::unique_ptr<DeviceJointOps> cuda_joint_ops(DeviceSums sums) {
  return std::make_unique<GridJointOps<CudaGrid>>(cuda_grid(), sums);
}

}  // namespace ngs
