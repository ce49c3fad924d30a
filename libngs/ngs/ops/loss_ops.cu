#include "ngs/ops/cuda_ops.cuh"
#include "ngs/ops/grid_loss_ops.h"

namespace ngs {

std::unique_ptr<DeviceLossOps> cuda_loss_ops() { return std::make_unique<GridLossOps<CudaGrid>>(cuda_grid()); }

}  // namespace ngs
