#pragma once
// One entry point for the readers of all formats but PLY.
#include <string>

#include "ngs/io/formats/splat_format.h"
#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// `format` must not be PLY. Throws kBadInput.
DecodedSplat decode_splat(SplatFormat format, const std::string& name, Bytes bytes);

}  // namespace ngs::io
