// The compositing kernels without an intrinsic: what a processor gets for which there is nothing better, and what the
// tests hold the others against.
#include "ngs/math/lanes_portable.h"
#include "ngs/ops/splat/tile_kernels_of.h"

namespace ngs {

TileKernels<float> float_tile_kernels_portable();
TileKernels<float> float_tile_kernels_portable() { return tile_kernels_of<PortablePack>(); }

}  // namespace ngs
