#pragma once
// Models in .sog (PlayCanvas; specification: developer.playcanvas.com, "The SOG Format"): a zip archive of meta.json
// and WebP pictures, a texel per Gaussian, row by row. The frame is that of a PLY.
//
//   means_l, means_u   low and high bytes of sign(p) ln(1 + |p|), between "mins" and "maxs"
//   quats              the three smallest components · √2 as (byte / 255) · 2 - 1, and 252 + the largest of w x y z
//   scales             ln scale, by index into a codebook (version 1: between mins and maxs)
//   sh0                colour by index into a codebook, opacity in 255ths (version 1: all between mins and maxs,
//   opacity
//                      as a logit)
//   shN_labels         16 bits that choose an entry of shN_centroids, which has 64 entries a row, a texel per
//                      coefficient, red green blue by index into a codebook (version 1: between mins and maxs)
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// Version 1 and 2. kBadInput for anything but a whole file; every size is checked before memory is taken.
DecodedSplat decode_sog(const std::string& name, Bytes bytes);

/// Version 2, rows along a Morton curve. Largest errors: position (1 + |p|) · (span of ln(1 + |p|)) / 131070, opacity
/// 1/510, components of the rotation but the largest 0.0028. Log scales and colours become the nearest of 256 values
/// that are best in the mean. Of SH, up to 65536 different sets are kept, each coefficient as the nearest of 256
/// values; more are grouped and become means (codebook.h). The same model gives the same bytes.
std::vector<std::uint8_t> encode_sog(const SplatSelection& model);

}  // namespace ngs::io
