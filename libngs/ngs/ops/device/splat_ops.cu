#include "ngs/ops/device/cuda_op_groups.cuh"
#include "ngs/ops/device/launched_splat_ops.h"

namespace ngs {

std::unique_ptr<DeviceSplatOps> cuda_splat_ops(DeviceSums sums) {
  return std::make_unique<LaunchedSplatOps<CudaLauncher>>(cuda_launcher(), sums);
}

}  // namespace ngs
