#pragma once
// Writer of SuperSplat's compressed.ply: chunks of 256 Gaussians with the range of each value, 16 bytes per Gaussian
// quantised within these ranges, SH as bytes. Reader: io/ply/compressed_ply.cpp.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Rows are sorted along a Morton curve, so that chunks are small. Largest errors: chunk range / 4094 for x, z and the
/// first and third log scale; range / 2046 for y and the second log scale; range / 510 for rgb; 1/510 for opacity;
/// 0.0007 for rotation components except the largest; 1/64 for SH within ±3.97. Equal models give equal bytes.
std::vector<std::uint8_t> encode_compressed_ply(const SplatSelection& model);

/// Rows in chunks so wide that the quantisation error exceeds the Gaussians' size.
Rounding compressed_ply_rounding(const SplatSelection& model);

}  // namespace ngs::io
