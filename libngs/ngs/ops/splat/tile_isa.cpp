#include "ngs/ops/splat/tile_isa.h"

#include "ngs/ops/splat/tile_kernels_of.h"

namespace ngs {

TileKernels<float> float_tile_kernels_portable();  // isa/tile_isa_portable.cpp
#ifdef NGS_WITH_V3
TileKernels<float> float_tile_kernels_v3();  // isa/tile_isa_v3.cpp
#endif
#ifdef NGS_WITH_V4
TileKernels<float> float_tile_kernels_v4();  // isa/tile_isa_v4.cpp
#endif

TileKernels<float> float_tile_kernels(Isa isa) {
#ifdef NGS_WITH_V4
  if (isa == Isa::kV4) return float_tile_kernels_v4();
#endif
#ifdef NGS_WITH_V3
  if (isa == Isa::kV3) return float_tile_kernels_v3();
#endif
  if constexpr (base_isa() != Isa::kPortable)
    if (isa != Isa::kPortable) return tile_kernels_of<PackF>();
  return float_tile_kernels_portable();
}

}  // namespace ngs
