#include "ngs/io/files/atomic_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/os/output_file.h"

namespace ngs::io {
namespace {

int open_new(const std::filesystem::path& target, std::string& temporary) {
  static std::atomic<unsigned> counter{0};
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  for (;;) {
    const std::string name = ".ngs-" + std::to_string(os::process_id()) + "-" + std::to_string(counter++) + ".tmp" +
                             target.extension().string();
    temporary = (folder / name).string();
    const int descriptor = os::create_file(temporary);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)), target_(path_) {
  const os::PathKind kind = os::kind_of_path(path_);
  if (kind == os::PathKind::kFolder) {
    errno = EISDIR;
    fail("cannot be written");
  }
  if (kind != os::PathKind::kNothing) {
    direct_ = kind == os::PathKind::kOther;
    std::error_code ignored;
    const auto resolved = std::filesystem::canonical(path_, ignored);
    if (!direct_ && !ignored) target_ = resolved.string();
  }
  if (direct_) {
    temporary_ = path_;
    descriptor_ = os::open_to_write(path_);
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
  os::close_file(descriptor_);
  if (!direct_) os::remove_file(temporary_.c_str());
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
    const std::int64_t written = os::write_some(descriptor_, from, std::min(bytes, std::size_t(1) << 30));
    if (written < 0) fail("writing failed");
    from += written;
    bytes -= std::size_t(written);
    written_bytes_ += written;
  }
  start_write_back();
}

void AtomicFile::start_write_back() {
  constexpr std::int64_t kAtOnceBytes = 32 << 20;
  if (direct_ || written_bytes_ - started_bytes_ < kAtOnceBytes) return;
  os::start_write_back(descriptor_, started_bytes_, written_bytes_ - started_bytes_);
  started_bytes_ = written_bytes_;  // on failure commit() writes everything
}

void AtomicFile::commit() {
  NGS_CHECK(descriptor_ >= 0, "commit called twice: " + path_);
  if (!direct_ && !os::sync_file(descriptor_)) fail("writing failed");
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (direct_) return os::close_file(descriptor);
  if (os::replace_file(descriptor, temporary_, target_)) return;
  const int reason = errno;
  os::remove_file(temporary_.c_str());
  errno = reason;
  fail("cannot be written");
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

namespace {

// Fixed storage: a signal handler may neither allocate nor lock.
enum SlotState : int { kFree, kFilling, kTracked };
struct Slot {
  std::atomic<int> state{kFree};
  char path[4096];
};
Slot slots[64];
static_assert(std::atomic<int>::is_always_lock_free, "needed in a signal handler");

}  // namespace

void UnfinishedFile::track(const char* path) {
  release();
  if (std::strlen(path) >= sizeof slots[0].path) return;  // not tracked, see the header
  for (int i = 0; i < int(sizeof slots / sizeof slots[0]); ++i) {
    int free = kFree;
    if (!slots[i].state.compare_exchange_strong(free, kFilling)) continue;
    std::strcpy(slots[i].path, path);
    slots[i].state = kTracked;
    slot_ = i;
    return;
  }
}

void UnfinishedFile::release() {
  if (slot_ >= 0) slots[slot_].state = kFree;
  slot_ = -1;
}

void remove_unfinished_files() noexcept {
  for (Slot& slot : slots)
    if (slot.state == kTracked) os::remove_file(slot.path);
  // Folders after files: a folder must be empty.
  for (Slot& slot : slots)
    if (slot.state == kTracked) os::remove_folder(slot.path);
}

}  // namespace ngs::io
