#include "ngs/backend/for_each_cuda.cuh"
#include "ngs/ops/volume_kernels.h"

NGS_CUDA_KERNEL(ngs::VolumeForward<float>);
NGS_CUDA_KERNEL(ngs::VolumeBackward<float>);
