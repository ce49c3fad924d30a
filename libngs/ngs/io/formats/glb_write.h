#pragma once
// Binary glTF with KHR_gaussian_splatting (Khronos, ratified): points with ROTATION (x y z w), SCALE (not its
// logarithm), OPACITY (0 to 1) and the coefficients of SH as float attributes. The frame is x left, y up, z forward.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Rows in order, as float: nothing is lost but the rounding of exp and of the opacity. kUsage beyond 4 GiB, where a
/// .glb ends. The same model gives the same bytes.
std::vector<std::uint8_t> encode_glb(const SplatSelection& model);

}  // namespace ngs::io
