#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "ngs/os/output_file.h"

namespace ngs::os {
namespace {

void sync_folder(const std::string& target) {
  const std::filesystem::path parent = std::filesystem::path(target).parent_path();
  const int descriptor = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

PathKind kind_of_path(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return PathKind::kNothing;
  if (S_ISDIR(status.st_mode)) return PathKind::kFolder;
  return S_ISREG(status.st_mode) ? PathKind::kRegular : PathKind::kOther;
}

int process_id() { return ::getpid(); }

// mode 0666 & ~umask, as every ordinary output has; mkstemp would leave 0600.
int create_file(const std::string& path) { return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); }

int open_to_write(const std::string& path) { return ::open(path.c_str(), O_WRONLY | O_CLOEXEC); }

std::int64_t write_some(int descriptor, const void* data, std::size_t bytes) {
  for (;;) {
    const ssize_t written = ::write(descriptor, data, bytes);
    if (written >= 0 || errno != EINTR) return written;
  }
}

void start_write_back([[maybe_unused]] int descriptor, [[maybe_unused]] std::int64_t offset,
                      [[maybe_unused]] std::int64_t bytes) {
#ifdef __linux__
  ::sync_file_range(descriptor, offset, bytes, SYNC_FILE_RANGE_WRITE);
#endif
}

bool sync_file(int descriptor) { return ::fsync(descriptor) == 0; }

bool replace_file(int descriptor, const std::string& path, const std::string& target) {
  const int failed = ::rename(path.c_str(), target.c_str()) == 0 ? 0 : errno;
  ::close(descriptor);
  if (failed == 0) sync_folder(target);
  errno = failed;
  return failed == 0;
}

void close_file(int descriptor) { ::close(descriptor); }
void remove_file(const char* path) noexcept { ::unlink(path); }
void remove_folder(const char* path) noexcept { ::rmdir(path); }

}  // namespace ngs::os
