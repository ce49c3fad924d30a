// The only translation unit for x86-64-v4. It must define no symbol that the linker could merge with another unit's:
// everything is inlined or has Pack16 in its name (checked by tests/meta/isa_test.cpp).
#include "ngs/math/lanes16.h"
#include "ngs/ops/splat/tile_kernels_of.h"

#ifdef __AVX512F__
namespace ngs {

// Declared here: no header may be shared with other instruction sets (-Wmissing-declarations).
TileKernels<float> float_tile_kernels_v4();
TileKernels<float> float_tile_kernels_v4() { return tile_kernels_of<Pack16>(); }

}  // namespace ngs
#endif
