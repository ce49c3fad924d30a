#pragma once
// SuperSplat's compressed.ply: chunks of 256 Gaussians with the ranges of their values, and 16 bytes each within them;
// SH as bytes. io/ply/compressed_ply.cpp reads it.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Rows along a Morton curve, so that chunks are small. Largest errors: x and z, and the scales' first and third axis,
/// the chunk's range / 4094, y and the second axis its range / 2046, rgb its range / 510, opacity 1/510, components of
/// the rotation but the largest 0.0007, SH within ±3.97 1/64. The same model gives the same bytes.
std::vector<std::uint8_t> encode_compressed_ply(const SplatSelection& model);

/// Rows in chunks so wide that encode_compressed_ply() moves them farther than they are large.
Rounding compressed_ply_rounding(const SplatSelection& model);

}  // namespace ngs::io
