#pragma once
// Models in .splat (antimatter15): records of 32 bytes without a header. 3 float position, 3 float scale (not its
// logarithm), 4 bytes red green blue alpha, 4 bytes rotation w x y z as (byte - 128) / 128. No SH beyond the constant
// one; the frame is that of a PLY.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput where `bytes` are no whole records, or none.
DecodedSplat decode_dot_splat(const std::string& name, Bytes bytes);

/// Rows in order. Opacity is rounded to 1/255, so is rgb, which is cut to 0..1; components of the rotation to 1/128.
/// The sign of a quaternion, which means nothing, is chosen so that its largest component is negative: -1 has a byte, 1
/// has none.
std::vector<std::uint8_t> encode_dot_splat(const SplatSelection& model);

}  // namespace ngs::io
