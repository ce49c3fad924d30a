#pragma once
// Reads binary glTF with KHR_gaussian_splatting, uncompressed: what glb_write.h and splat-transform write.
#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// All splats of the file's scene, with the transforms of their nodes, in the frame of a PLY. Attributes are float or,
/// where glTF allows it, normalised integers. Throws kBadInput, also for a file without splats, for compressed ones,
/// and for nodes that reflect or scale unevenly.
DecodedSplat decode_glb(const std::string& name, Bytes bytes);

}  // namespace ngs::io
