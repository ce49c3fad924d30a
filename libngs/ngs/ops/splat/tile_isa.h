#pragma once
// The compositing kernels for float, by instruction set.
#include "ngs/backend/isa.h"
#include "ngs/ops/splat/tile_types.h"

namespace ngs {

/// Kernels for `isa`, which can_run. Same bytes from all.
TileKernels<float> float_tile_kernels(Isa isa);

}  // namespace ngs
