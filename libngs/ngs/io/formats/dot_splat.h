#pragma once
// .splat models (antimatter15): records of 32 bytes without a header. 3 float position, 3 float scale (linear, not
// logarithmic), 4 bytes red green blue alpha, 4 bytes rotation w x y z as (byte - 128) / 128. SH of degree 0 only; the
// frame is that of a PLY.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput unless `bytes` are one or more complete records.
DecodedSplat decode_dot_splat(const std::string& name, Bytes bytes);

/// Rows in order. Opacity and rgb are rounded to 1/255, rgb is clamped to 0..1; rotation components are rounded to
/// 1/128. Of the two signs of a quaternion the one with a negative largest component is written, because a byte can
/// represent -1 but not 1.
std::vector<std::uint8_t> encode_dot_splat(const SplatSelection& model);

}  // namespace ngs::io
