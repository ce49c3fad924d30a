#pragma once
// The readers of the formats that are no PLY, behind one function.
#include <string>

#include "ngs/io/formats/splat_format.h"
#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// `format` is no PLY. Throws kBadInput.
DecodedSplat decode_splat(SplatFormat format, const std::string& name, Bytes bytes);

}  // namespace ngs::io
