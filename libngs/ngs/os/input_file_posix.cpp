#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "ngs/os/input_file.h"

namespace ngs::os {
namespace {

struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

/// A pipe in a folder. Those of a shell, such as <(command), have a program that writes to them.
bool is_named_pipe(const std::string& path) {
  struct stat status {};
  return !path.starts_with("/dev/") && !path.starts_with("/proc/") && ::stat(path.c_str(), &status) == 0 &&
         S_ISFIFO(status.st_mode);
}

/// `waits`: for a program that opens the pipe `descriptor` to write, which was opened with O_NONBLOCK.
int read_all(int descriptor, bool waits, std::vector<std::uint8_t>& bytes) {
  constexpr int kWait_ms = 10'000;
  const bool must_have_bytes = waits;
  for (std::size_t used = 0;;) {
    if (used == bytes.size()) bytes.resize(bytes.size() * 2 + (1 << 16));
    const ssize_t n = ::read(descriptor, bytes.data() + used, bytes.size() - used);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) {  // a program has opened it
      if (::fcntl(descriptor, F_SETFL, 0) != 0) return errno;
      continue;
    }
    if (n < 0) return errno;
    if (n == 0 && waits) {
      pollfd data{descriptor, POLLIN, 0};
      ::poll(&data, 1, kWait_ms);
      waits = false;
      continue;
    }
    if (n == 0 && used == 0 && must_have_bytes) return EPIPE;
    waits = false;
    if (n == 0) {
      bytes.resize(used);
      return 0;
    }
    used += std::size_t(n);
  }
}

}  // namespace

int load_file(const std::string& path, FileBytes& bytes) {
  const bool waits = is_named_pipe(path);
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | (waits ? O_NONBLOCK : 0))};
  if (file.value < 0) return errno;
  struct stat status {};
  if (::fstat(file.value, &status) != 0) return errno;
  if (S_ISDIR(status.st_mode)) return EISDIR;
  if (!S_ISREG(status.st_mode)) return read_all(file.value, waits, bytes.read);
  if (status.st_size == 0) return 0;
  void* map = ::mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE, file.value, 0);
  if (map == MAP_FAILED) return errno;
  bytes.map = static_cast<const std::uint8_t*>(map);
  bytes.map_bytes = std::size_t(status.st_size);
  ::madvise(map, bytes.map_bytes, MADV_SEQUENTIAL);
  return 0;
}

void unmap_file(const FileBytes& bytes) {
  if (bytes.map != nullptr) ::munmap(const_cast<std::uint8_t*>(bytes.map), bytes.map_bytes);
}

void forget_pages(const FileBytes& bytes) {
  if (bytes.map != nullptr) ::madvise(const_cast<std::uint8_t*>(bytes.map), bytes.map_bytes, MADV_DONTNEED);
}

const char* path_of_stdin() { return "/dev/stdin"; }

}  // namespace ngs::os
