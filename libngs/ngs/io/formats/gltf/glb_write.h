#pragma once
// Binary glTF with KHR_gaussian_splatting (Khronos, ratified): points with ROTATION (x y z w), SCALE (linear), OPACITY
// (0 to 1) and SH coefficients as float attributes. The frame is x left, y up, z forward.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Rows in order, as float: the only loss is rounding of exp(log scale) and of the opacity. kUsage beyond 4 GiB, the
/// limit of .glb. Equal models give equal bytes.
std::vector<std::uint8_t> encode_glb(const SplatSelection& model);

}  // namespace ngs::io
