#pragma once
// Models in .ksplat (mkkellogg's GaussianSplats3D), version 0.1 and later of 0: a header of 4096 bytes, a header of
// 1024 bytes per section, then the sections: sizes of the buckets that are not full, centres of all buckets, Gaussians.
//
//   compression 0  position, scale, rotation and SH as floats        1  16-bit positions about the bucket's centre, the
//   others half floats                                               2  as 1, with SH as bytes between two ends
//
// Colour and opacity are bytes in all; scales are no logarithms; rotation w x y z; the frame is that of a PLY.
#include <string>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput for anything but a whole file; every count is checked against its size before memory is taken.
DecodedSplat decode_ksplat(const std::string& name, Bytes bytes);

}  // namespace ngs::io
