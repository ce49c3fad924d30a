#include "ngs/ops/splat/tile_isa.h"

#include "ngs/ops/splat/tile_kernels_of.h"

namespace ngs {

#ifdef NGS_WITH_V4
TileKernels<float> float_tile_kernels_v4();  // tile_isa_v4.cpp
#endif

TileKernels<float> float_tile_kernels(Isa isa) {
#ifdef NGS_WITH_V4
  if (isa == Isa::kV4) return float_tile_kernels_v4();
#endif
  (void)isa;
  return tile_kernels_of<PackF>();
}

}  // namespace ngs
