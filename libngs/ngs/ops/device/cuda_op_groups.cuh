#pragma once
// The groups of ops that cuda_ops() joins, one per .cu file so that they compile in parallel.
#include <memory>

#include "ngs/backend/cuda_launcher.cuh"
#include "ngs/ops/device/device_ops.h"

namespace ngs {

CudaLauncher& cuda_launcher();
std::unique_ptr<DeviceSplatOps> cuda_splat_ops(DeviceSums sums);
std::unique_ptr<DeviceFieldOps> cuda_field_ops(DeviceSums sums);
std::unique_ptr<DeviceLossOps> cuda_loss_ops();

}  // namespace ngs
