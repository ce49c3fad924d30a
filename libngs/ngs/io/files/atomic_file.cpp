#include "ngs/io/files/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "ngs/core/check.h"
#include "ngs/core/error.h"

namespace ngs::io {
namespace {

// mode 0666 & ~umask, as every ordinary output has; mkstemp would leave 0600.
int open_new(const std::filesystem::path& target, std::string& temporary) {
  static std::atomic<unsigned> counter{0};
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  for (;;) {
    const std::string name =
        ".ngs-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp" + target.extension().string();
    temporary = (folder / name).string();
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
}

void sync_folder(const std::string& target) {
  const std::filesystem::path parent = std::filesystem::path(target).parent_path();
  const int descriptor = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), target_(path_) {
  struct stat status {};
  if (::stat(path_.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) {
      errno = EISDIR;
      fail("cannot be written");
    }
    direct_ = !S_ISREG(status.st_mode);
    std::error_code ignored;
    const auto resolved = std::filesystem::canonical(path_, ignored);
    if (!direct_ && !ignored) target_ = resolved.string();
  }
  if (direct_) {
    temporary_ = path_;
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    descriptor_ = open_new(target_, temporary_);
    if (descriptor_ >= 0) unfinished_.track(temporary_.c_str());
  }
  if (descriptor_ < 0) {
    temporary_.clear();
    fail("cannot be written");
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!direct_) ::unlink(temporary_.c_str());
}

void AtomicFile::fail(const char* what) const {
  const int reason = errno;
  const bool no_folder = reason == ENOENT || reason == ENOTDIR;
  throw Error(ErrorCode::kEnvironment, path_ + ": " + what + ": " + std::strerror(reason),
              no_folder ? "create the folder first: mkdir -p" : "");
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  NGS_CHECK(descriptor_ >= 0, "write after commit: " + path_);
  const char* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = ::write(descriptor_, from, std::min(bytes, std::size_t(1) << 30));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("writing failed");
    from += written;
    bytes -= std::size_t(written);
    written_bytes_ += written;
  }
  start_write_back();
}

void AtomicFile::start_write_back() {
#ifdef __linux__
  constexpr std::int64_t kAtOnceBytes = 32 << 20;
  if (direct_ || written_bytes_ - started_bytes_ < kAtOnceBytes) return;
  ::sync_file_range(descriptor_, started_bytes_, written_bytes_ - started_bytes_, SYNC_FILE_RANGE_WRITE);
  started_bytes_ = written_bytes_;  // on failure commit() writes everything
#endif
}

void AtomicFile::commit() {
  NGS_CHECK(descriptor_ >= 0, "commit called twice: " + path_);
  if (!direct_ && ::fsync(descriptor_) != 0) fail("writing failed");
  const int descriptor = descriptor_;
  if (!direct_ && ::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be written");
  descriptor_ = -1;
  ::close(descriptor);
  if (!direct_) sync_folder(target_);
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace ngs::io
