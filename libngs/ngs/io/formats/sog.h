#pragma once
// .sog models (PlayCanvas; specification: developer.playcanvas.com, "The SOG Format"): a zip archive of meta.json and
// WebP images, one texel per Gaussian, row by row. The frame is that of a PLY.
//
// clang-format off
//   means_l, means_u   low and high bytes of sign(p) ln(1 + |p|), between "mins" and "maxs"
//   quats              the three smallest components · √2 as (byte / 255) · 2 - 1, and 252 + index of the largest of
//                      w x y z
//   scales             ln scale, as index into a codebook (version 1: between mins and maxs)
//   sh0                colour as index into a codebook, opacity in 255ths (version 1: all between mins and maxs,
//                      opacity as a logit)
//   shN_labels         16-bit index of an entry of shN_centroids
//   shN_centroids      64 entries per image row, one texel per coefficient: red green blue as indices into a codebook
//                      (version 1: between mins and maxs)
// clang-format on
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Versions 1 and 2. kBadInput unless the file is complete; every size is checked before memory is allocated.
DecodedSplat decode_sog(const std::string& name, Bytes bytes);

/// Writes version 2, rows sorted along a Morton curve. Largest errors: position (1 + |p|) · (span of ln(1 + |p|)) /
/// 131070, opacity 1/510, rotation components except the largest 0.0028. Log scales and colours become the nearest of
/// 256 values that minimise the mean squared error. Up to 65536 distinct SH rows are kept, each coefficient as the
/// nearest of 256 values; more are clustered and replaced by means (codebook.h). Equal models give equal bytes.
std::vector<std::uint8_t> encode_sog(const SplatSelection& model);

}  // namespace ngs::io
