#include "ngs/ops/cuda_ops.cuh"
#include "ngs/ops/grid_field_ops.h"

namespace ngs {

std::unique_ptr<DeviceFieldOps> cuda_field_ops(DeviceSums sums) {
  return std::make_unique<GridFieldOps<CudaGrid>>(cuda_grid(), sums);
}

}  // namespace ngs
