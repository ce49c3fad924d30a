#pragma once
// Files whose paths come from other files. Unlike a user's argument, such a path may be unsafe to open: a pipe would
// block, a device would never end.
#include <string>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

bool is_regular_file(const std::string& path);

/// Throws kBadInput if `path` exists and is not a regular file. A missing file is reported when it is opened.
void require_regular_file(const std::string& path);

/// Throws kBadInput unless `path` is a readable regular file.
MappedFile map_regular_file(const std::string& path);

}  // namespace ngs::io
