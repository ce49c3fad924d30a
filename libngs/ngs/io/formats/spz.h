#pragma once
// .spz models, versions 1 to 4. The file's frame is x right, y up, z back unless extension 0xADBE0003 names another;
// models are converted to and from the frame of a PLY.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput unless the file is complete; sizes are checked before memory is allocated. SH of degree 4 are truncated to
/// degree 3.
DecodedSplat decode_spz(const std::string& name, Bytes bytes);

/// Writes version 3. Positions are rounded to 2^-bits (error: half a step), with at most 16 fractional bits and as many
/// as the largest coordinate leaves of 23 bits and a sign. Other attributes have an error of half a step within their
/// range and are clamped outside: opacity 1/255; colour f_dc ±3.33, step 0.0261; ln scale -10 to 5.94, step 1/16; SH -1
/// to 0.99, step 1/128; rotation components except the largest, step 0.00138. Equal models give equal bytes. kUsage for
/// a coordinate beyond 2^23.
std::vector<std::uint8_t> encode_spz(const SplatSelection& model);

/// Rows whose rounding error in encode_spz() exceeds the Gaussians' size.
Rounding spz_rounding(const SplatSelection& model);

}  // namespace ngs::io
