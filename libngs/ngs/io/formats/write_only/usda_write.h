#pragma once
// OpenUSD text with a prim of ParticleField3DGaussianSplat (UsdVol, OpenUSD 26.03): linear scales and opacities, unit
// quaternions w x y z, SH coefficients with the constant one first. The frame is x right, y up, z back.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Rows in order. Numbers are the shortest that read back as the same float, so the only loss is rounding of exp(log
/// scale) and of the opacity. Equal models give equal bytes.
std::vector<std::uint8_t> encode_usda(const SplatSelection& model);

}  // namespace ngs::io
