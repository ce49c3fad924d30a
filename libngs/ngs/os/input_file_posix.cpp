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

/// Waits for a program that writes into a named pipe, which was opened with O_NONBLOCK so that open() did not wait.
int wait_for_writer(int descriptor) {
  constexpr int kWait_ms = 10'000;
  pollfd data{descriptor, POLLIN, 0};
  ::poll(&data, 1, kWait_ms);
  return ::fcntl(descriptor, F_SETFL, 0) == 0 ? 0 : errno;
}

/// `expected`: number of bytes, if known; the file may have another.
int read_all(int descriptor, std::size_t expected, std::vector<std::uint8_t>& bytes) {
  bytes.resize(expected + 1);  // so that the end is found without growing
  for (std::size_t used = 0;;) {
    if (used == bytes.size()) bytes.resize(bytes.size() * 2 + (1 << 16));
    const ssize_t n = ::read(descriptor, bytes.data() + used, bytes.size() - used);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    used += std::size_t(n);
    if (n > 0) continue;
    bytes.resize(used);
    return 0;
  }
}

}  // namespace

bool is_pipe(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
}

bool is_device(const std::string& path) {
  struct stat status {
  }, null{};
  if (::stat(path.c_str(), &status) != 0) return false;
  const bool is_null = ::stat("/dev/null", &null) == 0 && status.st_rdev == null.st_rdev;
  return S_ISBLK(status.st_mode) || (S_ISCHR(status.st_mode) && !is_null);
}

int load_file(const std::string& path, FileBytes& bytes) {
  // The pipes of a shell, such as <(command), have a program that writes to them.
  const bool waits = is_pipe(path) && !path.starts_with("/dev/") && !path.starts_with("/proc/");
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | (waits ? O_NONBLOCK : 0))};
  if (file.value < 0) return errno;
  struct stat status {};
  if (::fstat(file.value, &status) != 0) return errno;
  if (S_ISDIR(status.st_mode)) return EISDIR;
  if (is_device(path)) return ENODEV;
  if (!S_ISREG(status.st_mode)) {
    int error = waits ? wait_for_writer(file.value) : 0;
    if (error == 0) error = read_all(file.value, 0, bytes.read);
    return error == 0 && waits && bytes.read.empty() ? EPIPE : error;
  }
  if (status.st_size == 0) return 0;
  void* map = ::mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE, file.value, 0);
  if (map == MAP_FAILED && errno == ENODEV)  // by a file system that cannot map, such as the files of a browser
    return read_all(file.value, std::size_t(status.st_size), bytes.read);
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
