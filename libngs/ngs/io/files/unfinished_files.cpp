#include "ngs/io/files/unfinished_files.h"

#include <atomic>
#include <cstring>

#include "ngs/os/output_file.h"

namespace ngs::io {
namespace {

// Fixed storage: a signal handler may neither allocate nor lock.
struct Slot {
  std::atomic<int> state{0};  // 0 free, 1 being filled, 2 holds a path
  char path[4096];
};
Slot slots[64];
static_assert(std::atomic<int>::is_always_lock_free, "needed in a signal handler");

}  // namespace

void UnfinishedFile::note(const char* path) {
  release();
  if (std::strlen(path) >= sizeof slots[0].path) return;
  for (int i = 0; i < int(sizeof slots / sizeof slots[0]); ++i) {
    int free = 0;
    if (!slots[i].state.compare_exchange_strong(free, 1)) continue;
    std::strcpy(slots[i].path, path);
    slots[i].state = 2;
    slot_ = i;
    return;
  }
}

void UnfinishedFile::release() {
  if (slot_ >= 0) slots[slot_].state = 0;
  slot_ = -1;
}

void remove_unfinished_files() noexcept {
  for (Slot& slot : slots)
    if (slot.state == 2) os::remove_file(slot.path);
  for (Slot& slot : slots)
    if (slot.state == 2) os::remove_folder(slot.path);
}

}  // namespace ngs::io
