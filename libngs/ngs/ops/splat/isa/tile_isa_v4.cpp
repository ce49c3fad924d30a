// The only translation unit for x86-64-v4. It defines nothing that the linker could share with the others: everything
// in it is inlined or named after Pack16 (tests/meta/isa_test.cpp looks).
#include "ngs/math/lanes16.h"
#include "ngs/ops/splat/tile_kernels_of.h"

#ifdef __AVX512F__
namespace ngs {

TileKernels<float> float_tile_kernels_v4();
TileKernels<float> float_tile_kernels_v4() { return tile_kernels_of<Pack16>(); }

}  // namespace ngs
#endif
