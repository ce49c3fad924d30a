#include "ngs/ops/cuda_ops.cuh"

namespace ngs {

CudaGrid& cuda_grid() {
  static CudaGrid grid;
  return grid;
}

const DeviceOps* cuda_ops() {
  static const std::unique_ptr<DeviceSplatOps> splat = cuda_splat_ops();
  static const std::unique_ptr<DeviceFieldOps> field = cuda_field_ops();
  static const std::unique_ptr<DeviceLossOps> loss = cuda_loss_ops();
  static const std::unique_ptr<DeviceJointOps> joint = cuda_joint_ops();
  static const DeviceOps ops(*splat, *field, *loss, joint.get());
  return &ops;
}

}  // namespace ngs
