#include "ngs/backend/for_each_cuda.cuh"
#include "ngs/ops/hash_grid_kernels.h"

NGS_CUDA_KERNEL(ngs::HashForward<float, 2>);
NGS_CUDA_KERNEL(ngs::HashBackwardPosition<float, 2>);
