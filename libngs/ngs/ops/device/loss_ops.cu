#include "ngs/ops/device/cuda_op_groups.cuh"
#include "ngs/ops/device/launched_loss_ops.h"

namespace ngs {

std::unique_ptr<DeviceLossOps> cuda_loss_ops() {
  return std::make_unique<LaunchedLossOps<CudaLauncher>>(cuda_launcher());
}

}  // namespace ngs
