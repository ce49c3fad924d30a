#include "ngs/io/files/unfinished_files.h"

#include <atomic>
#include <cstring>

#include "ngs/os/output_file.h"

namespace ngs::io {
namespace {

// Fixed storage: a signal handler may neither allocate nor lock.
enum State : int { kFree, kFilling, kTracked };
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
