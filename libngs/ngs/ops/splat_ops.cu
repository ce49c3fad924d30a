#include "ngs/ops/cuda_ops.cuh"
#include "ngs/ops/grid_splat_ops.h"

namespace ngs {

std::unique_ptr<DeviceSplatOps> cuda_splat_ops(DeviceSums sums) {
  return std::make_unique<GridSplatOps<CudaGrid>>(cuda_grid(), sums);
}

}  // namespace ngs
