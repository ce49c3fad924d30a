#pragma once
// The memory of the emulated device. If it is guarded, host code that touches it outside of a launch or copy faults, as
// on a real device; each launch then costs two system calls.
#include <sys/mman.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <new>

#include "ngs/core/check.h"
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#endif

namespace ngs::test {

class GuardedMemory {
 public:
  /// Memory is accessible while an object of this class exists.
  class Access {
   public:
    explicit Access(GuardedMemory& memory) : memory_(memory) { memory_.protect(PROT_READ | PROT_WRITE); }
    ~Access() { memory_.protect(PROT_NONE); }
    Access(const Access&) = delete;
    Access& operator=(const Access&) = delete;

   private:
    GuardedMemory& memory_;
  };

  explicit GuardedMemory(bool guarded)
      : guarded_(guarded),
        base_(static_cast<char*>(mmap(nullptr, kReserved, guarded ? PROT_NONE : PROT_READ | PROT_WRITE,
                                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0))) {
    if (base_ == MAP_FAILED) throw std::bad_alloc();
    forbid(base_, kReserved);
  }
  ~GuardedMemory() { munmap(base_, kReserved); }
  GuardedMemory(const GuardedMemory&) = delete;
  GuardedMemory& operator=(const GuardedMemory&) = delete;

  bool empty() const { return taken_.empty(); }

  /// All bits set, so that floats are NaN. The address sanitizer knows the exact size.
  void* allocate(std::size_t bytes) {
    const std::size_t size = (bytes / kPage + 1) * kPage;  // at least one byte that is not in use
    std::size_t at = 0;
    for (const auto& [begin, taken] : taken_) {
      if (begin - at >= size) break;
      at = begin + taken;
    }
    NGS_CHECK(at + size <= kReserved, "the emulated device has enough memory");
    taken_[at] = size;
    allow(base_ + at, bytes);
    const Access access(*this);
    return std::memset(base_ + at, 0xff, bytes);
  }
  void release(void* memory) noexcept {
    const auto found = taken_.find(std::size_t(static_cast<char*>(memory) - base_));
    forbid(memory, found->second);
    taken_.erase(found);
  }

 private:
  static constexpr std::size_t kReserved = std::size_t(1) << 32, kPage = 1 << 16;  // of any processor
  static void forbid([[maybe_unused]] const void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__)
    __asan_poison_memory_region(begin, bytes);
#endif
  }
  static void allow([[maybe_unused]] const void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__)
    __asan_unpoison_memory_region(begin, bytes);
#endif
  }
  void protect(int access) {
    if (!guarded_ || empty()) return;
    const auto& [begin, size] = *taken_.rbegin();
    NGS_CHECK(mprotect(base_, begin + size, access) == 0, "device memory can be protected");
  }

  bool guarded_;
  char* base_;
  std::map<std::size_t, std::size_t> taken_;  // offset -> size
};

}  // namespace ngs::test
