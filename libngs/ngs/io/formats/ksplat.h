#pragma once
// .ksplat models (mkkellogg's GaussianSplats3D), versions 0.1 and later 0.x. Layout: a header of 4096 bytes, a header
// of 1024 bytes per section, then per section: sizes of the partially filled buckets, centres of all buckets,
// Gaussians.
//
// clang-format off
//   compression 0   position, scale, rotation and SH as floats
//   compression 1   positions as 16 bits about the bucket centre; scale, rotation and SH as half floats
//   compression 2   as 1, but SH as bytes between a minimum and a maximum
// clang-format on
//
// Colour and opacity are always bytes; scales are linear, not logarithmic; rotation is w x y z; the frame is that of a
// PLY.
#include <string>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput unless the file is complete. Every count is checked against the file size before memory is allocated.
DecodedSplat decode_ksplat(const std::string& name, Bytes bytes);

}  // namespace ngs::io
