#pragma once
// Reads small text files completely.
#include <string>

#include "ngs/core/error.h"

namespace ngs::cli {

/// The bytes of a file of at most 64 MiB. Throws `code` if it cannot be read.
std::string read_text_file(const std::string& path, ErrorCode code);

}  // namespace ngs::cli
