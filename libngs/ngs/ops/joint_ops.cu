#include "ngs/ops/cuda_ops.cuh"
#include "ngs/ops/joint_step_grid.h"

namespace ngs {

std::unique_ptr<DeviceJointOps> cuda_joint_ops() { return std::make_unique<GridJointOps<CudaGrid>>(cuda_grid()); }

}  // namespace ngs
