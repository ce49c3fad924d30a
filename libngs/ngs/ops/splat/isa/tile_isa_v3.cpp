// The only translation unit for x86-64-v3 in a build for any x86-64 (NGS_ISA=portable). It must define no symbol that
// the linker could merge with another unit's: everything is inlined or has PackF in its name (checked by
// tests/meta/isa_test.cpp).
#ifdef NGS_WITH_V3
#include "ngs/ops/splat/tile_kernels_of.h"

namespace ngs {

TileKernels<float> float_tile_kernels_v3();
TileKernels<float> float_tile_kernels_v3() { return tile_kernels_of<PackF>(); }

}  // namespace ngs
#endif
