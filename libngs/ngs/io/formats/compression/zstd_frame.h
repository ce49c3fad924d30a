#pragma once
// Zstandard frames of a size that is known beforehand.
#include <cstdint>
#include <string>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

/// Fills `out` from the frames in `frames`. kBadInput, in the name of `object`, where they hold more or less than that.
void unzstd(const std::string& object, Bytes frames, std::span<std::uint8_t> out);

}  // namespace ngs::io
