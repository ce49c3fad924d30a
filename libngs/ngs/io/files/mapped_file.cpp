#include "ngs/io/files/mapped_file.h"

#include <cstring>

#include "ngs/core/error.h"

namespace ngs::io {

MappedFile::MappedFile(const std::string& path) {
  if (const int reason = os::load_file(path, bytes_); reason != 0)
    throw Error(ErrorCode::kBadInput, path + ": cannot be read: " + std::strerror(reason));
}

MappedFile::~MappedFile() { os::unmap_file(bytes_); }
void MappedFile::forget_pages() const { os::forget_pages(bytes_); }
void MappedFile::swap(MappedFile& other) noexcept { std::swap(bytes_, other.bytes_); }

}  // namespace ngs::io
