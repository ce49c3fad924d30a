#pragma once
// Files that other files name. Unlike an argument of the user, such a name is not trusted to be harmless to
// open: a pipe would hang, a device would never end.
#include <string>

#include "ngs/io/files/mapped_file.h"

namespace ngs::io {

bool is_regular_file(const std::string& path);

/// Throws kBadInput where `path` is something else than a regular file; what is not there opening it will tell.
void require_regular_file(const std::string& path);

/// Throws kBadInput unless `path` is a regular file that can be read.
MappedFile map_regular_file(const std::string& path);

}  // namespace ngs::io
