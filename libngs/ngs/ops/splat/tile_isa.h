#pragma once
// The compositing kernels for float, by instruction set.
#include "ngs/backend/isa.h"
#include "ngs/ops/splat/tile_types.h"

namespace ngs {

/// Kernels for `isa`, or for x86-64-v3 where this build has none for it. Same bytes from all.
TileKernels<float> float_tile_kernels(Isa isa);

}  // namespace ngs
