#include "ngs/ops/device/cuda_op_groups.cuh"
#include "ngs/ops/device/cuda_ops.h"
#include "ngs/ops/device/launched_arrays.h"

namespace ngs {

CudaLauncher& cuda_launcher() {
  static CudaLauncher launcher;
  return launcher;
}

namespace {

struct CudaOps {
  std::unique_ptr<DeviceSplatOps> splat;
  std::unique_ptr<DeviceFieldOps> field;
  std::unique_ptr<DeviceLossOps> loss = cuda_loss_ops();
  LaunchedArrays<CudaLauncher> arrays{cuda_launcher()};
  DeviceOps all{*splat, *field, *loss, arrays};
  explicit CudaOps(DeviceSums sums) : splat(cuda_splat_ops(sums)), field(cuda_field_ops(sums)) {}
};

}  // namespace

const DeviceOps* cuda_ops(DeviceSums sums) {
  static const CudaOps in_order(DeviceSums::kInOrder), atomic(DeviceSums::kAtomic);
  return sums == DeviceSums::kAtomic ? &atomic.all : &in_order.all;
}

}  // namespace ngs
