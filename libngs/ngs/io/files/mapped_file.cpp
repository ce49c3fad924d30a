#include "ngs/io/files/mapped_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/shell_word.h"

namespace ngs::io {

MappedFile::MappedFile(const std::string& path) {
  if (const int reason = os::load_file(path, bytes_); reason != 0)
    throw Error(ErrorCode::kBadInput,
                path + ": cannot be read: " +
                    (reason == EPIPE    ? "a pipe that no program writes to"
                     : reason == ENODEV ? kDevice
                                        : std::strerror(reason)),
                reason == EPIPE    ? "start the program that writes to it first, or name a file"
                : reason == EACCES ? "give yourself the right to read it: chmod u+r " + shell_word(path)
                                   : "");
}

MappedFile::~MappedFile() { os::unmap_file(bytes_); }
void MappedFile::forget_pages() const { os::forget_pages(bytes_); }
void MappedFile::swap(MappedFile& other) noexcept { std::swap(bytes_, other.bytes_); }

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
