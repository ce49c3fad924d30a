#include "ngs/io/files/mapped_file.h"

#include <cerrno>
#include <cstring>

#include "ngs/core/error.h"
#include "ngs/io/files/shell_word.h"

namespace ngs::io {

MappedFile::MappedFile(const std::string& path) {
  if (const int reason = os::load_file(path, bytes_); reason != 0)
    throw Error(
        ErrorCode::kBadInput,
        path + ": cannot be read: " + (reason == EPIPE ? "a pipe that no program writes to" : std::strerror(reason)),
        reason == EPIPE    ? "start the program that writes to it first, or name a file"
        : reason == EACCES ? "give yourself the right to read it: chmod u+r " + shell_word(path)
                           : "");
}

MappedFile::~MappedFile() { os::unmap_file(bytes_); }
void MappedFile::forget_pages() const { os::forget_pages(bytes_); }
void MappedFile::swap(MappedFile& other) noexcept { std::swap(bytes_, other.bytes_); }

}  // namespace ngs::io
