#pragma once
// Zstandard frames of known size.
#include <cstdint>
#include <string>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

/// Fills `out` from `frames`. kBadInput, with `object` in the message, if they hold more or fewer bytes than `out`.
void unzstd(const std::string& object, Bytes frames, std::span<std::uint8_t> out);

}  // namespace ngs::io
