// The only translation unit for x86-64-v3 of a build for any x86-64 (NGS_ISA=portable). It defines nothing that the
// linker could share with the others: everything in it is inlined or named after its PackF (tests/meta/isa_test.cpp
// looks).
#ifdef NGS_WITH_V3
#include "ngs/ops/splat/tile_kernels_of.h"

namespace ngs {

TileKernels<float> float_tile_kernels_v3();
TileKernels<float> float_tile_kernels_v3() { return tile_kernels_of<PackF>(); }

}  // namespace ngs
#endif
