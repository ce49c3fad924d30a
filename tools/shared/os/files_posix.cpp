#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "ngs/os/output_file.h"
#include "shared/os/files.h"

namespace ngs::os {

bool is_readable(const std::string& path) { return ::access(path.c_str(), R_OK) == 0; }
bool is_executable(const std::string& path) { return ::access(path.c_str(), X_OK) == 0; }

bool owner_keeps_rights() {
  const mode_t mask = ::umask(077);
  ::umask(mask);
  return (mask & 0700) == 0;
}

FileVersion version_of_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return {status.st_ino, 1'000'000'000LL * status.st_mtim.tv_sec + status.st_mtim.tv_nsec};
}

bool make_temporary_file(std::string& path) {
  const int descriptor = ::mkstemp(path.data());
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

bool make_temporary_folder(std::string& path) { return ::mkdtemp(path.data()) != nullptr; }

std::string file_of_bytes(std::string_view bytes) {
  const int descriptor = ::memfd_create("ngs", MFD_CLOEXEC);
  if (descriptor < 0) return {};
  while (!bytes.empty()) {
    const std::int64_t written = write_some(descriptor, bytes.data(), bytes.size());
    if (written < 0) return {};
    bytes.remove_prefix(std::size_t(written));
  }
  return "/proc/self/fd/" + std::to_string(descriptor);
}

int unnamed_file(std::string path) {
  const int descriptor = ::mkostemp(path.data(), O_CLOEXEC);
  if (descriptor >= 0) ::unlink(path.c_str());
  return descriptor;
}

int lock_folder(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0 || ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return -1;
}

void unlock_folder(int descriptor) { ::close(descriptor); }

std::int64_t read_at(int descriptor, void* to, std::size_t bytes, std::int64_t offset) {
  return ::pread(descriptor, to, bytes, offset);
}

std::int64_t size_of_file(int descriptor) { return ::lseek(descriptor, 0, SEEK_END); }

}  // namespace ngs::os
