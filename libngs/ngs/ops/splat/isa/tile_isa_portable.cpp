// The compositing kernels without intrinsics: the fallback for other processors and the reference in tests.
#include "ngs/math/lanes_portable.h"
#include "ngs/ops/splat/tile_kernels_of.h"

namespace ngs {

TileKernels<float> float_tile_kernels_portable();
TileKernels<float> float_tile_kernels_portable() { return tile_kernels_of<PortablePack>(); }

}  // namespace ngs
