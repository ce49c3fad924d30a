#include "ngs/io/files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "ngs/core/error.h"

namespace ngs::io {
namespace {

struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

[[noreturn]] void fail(const std::string& path, int reason) {
  throw Error(ErrorCode::kBadInput, path + ": cannot be read: " + std::strerror(reason));
}

std::vector<std::uint8_t> read_all(const std::string& path, int descriptor) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t used = 0;;) {
    if (used == bytes.size()) bytes.resize(bytes.size() * 2 + (1 << 16));
    const ssize_t n = ::read(descriptor, bytes.data() + used, bytes.size() - used);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(path, errno);
    if (n == 0) {
      bytes.resize(used);
      return bytes;
    }
    used += std::size_t(n);
  }
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.value < 0) fail(path, errno);
  struct stat status {};
  if (::fstat(file.value, &status) != 0) fail(path, errno);
  if (S_ISDIR(status.st_mode)) fail(path, EISDIR);
  if (!S_ISREG(status.st_mode)) {
    read_ = read_all(path, file.value);
    return;
  }
  if (status.st_size == 0) return;
  void* map = ::mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE, file.value, 0);
  if (map == MAP_FAILED) fail(path, errno);
  map_ = static_cast<const std::uint8_t*>(map);
  map_bytes_ = std::size_t(status.st_size);
  ::madvise(map, map_bytes_, MADV_SEQUENTIAL);
}

MappedFile::~MappedFile() {
  if (map_ != nullptr) ::munmap(const_cast<std::uint8_t*>(map_), map_bytes_);
}

void MappedFile::forget_pages() const {
  if (map_ != nullptr) ::madvise(const_cast<std::uint8_t*>(map_), map_bytes_, MADV_DONTNEED);
}

void MappedFile::swap(MappedFile& other) noexcept {
  std::swap(map_, other.map_);
  std::swap(map_bytes_, other.map_bytes_);
  std::swap(read_, other.read_);
}

}  // namespace ngs::io
