#pragma once
// The float compositing kernels, by instruction set.
#include "ngs/backend/isa.h"
#include "ngs/ops/splat/tile_types.h"

namespace ngs {

/// Kernels for `isa`; can_run(isa) must hold. All give the same bytes.
TileKernels<float> float_tile_kernels(Isa isa);

}  // namespace ngs
