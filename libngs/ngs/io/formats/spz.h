#pragma once
// Models in .spz, version 1 to 4. Its frame is x right, y up, z back, unless the file names another one (extension
// 0xADBE0003); models are turned into the frame of a PLY and back.
#include <string>
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// kBadInput for anything but a whole file; nothing is allocated before the file is known to hold as much. SH of degree
/// 4 are cut to 3.
DecodedSplat decode_spz(const std::string& name, Bytes bytes);

/// Version 3. Positions are rounded to 2^-bits, with as many bits as the farthest coordinate leaves room for (23 bits
/// and a sign in all), at most 16; half a step is the error. Other attributes lose at most half a step where they lie
/// within: opacity 1/255, colour f_dc ±3.33 in steps of 0.0261, ln scale -10 to 5.94 in steps of 1/16, SH -1 to 0.99 in
/// steps of 1/128, components of the rotation but the largest in steps of 0.00138. Beyond, the nearer end is kept. The
/// same model gives the same bytes. kUsage where a coordinate is beyond 2^23.
std::vector<std::uint8_t> encode_spz(const SplatSelection& model);

/// Where the steps of encode_spz() are so coarse that Gaussians are farther from their place than they are large.
Rounding spz_rounding(const SplatSelection& model);

}  // namespace ngs::io
