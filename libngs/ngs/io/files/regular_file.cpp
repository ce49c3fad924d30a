#include "ngs/io/files/regular_file.h"

#include <filesystem>

#include "ngs/core/error.h"

namespace ngs::io {

bool is_regular_file(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

void require_regular_file(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !is_regular_file(path))
    throw Error(ErrorCode::kBadInput, path + ": not a regular file, expected one");
}

MappedFile map_regular_file(const std::string& path) {
  require_regular_file(path);
  return MappedFile(path);
}

}  // namespace ngs::io
