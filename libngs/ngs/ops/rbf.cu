#include "ngs/backend/for_each_cuda.cuh"
#include "ngs/ops/rbf_kernels.h"

NGS_CUDA_KERNEL(ngs::RbfForward<float>);
NGS_CUDA_KERNEL(ngs::RbfBackwardFeature<float>);
