// The heap and columns of millions of rows use pages of 2 MiB if the system has them: the kernel is advised to use them
// (transparent huge pages). This saves 511 of 512 page faults, which take a quarter of a draft with 2e7 Gaussians
// (decision 077), and most misses of the TLB.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kPage = 4096, kMappedLarge = 4 << 20, kHeapLarge = 64 << 10;  // bytes

void advise(char* begin, char* end) {
  begin += (kPage - std::uintptr_t(begin) % kPage) % kPage;
  if (begin < end) madvise(begin, std::size_t(end - begin), MADV_HUGEPAGE);  // without effect where there are none
}

/// Advises the kernel about memory by which the heap has grown since the last call; the first call starts at `first`.
/// Memory that the heap returned and got again counts as new.
void advise_heap(char* first, char* heap_end) {
  static std::atomic<char*> advised = nullptr;
  char* const before = advised.exchange(heap_end);
  if (before < heap_end) advise(before == nullptr ? first : before, heap_end);
}

void* allocate(std::size_t bytes) noexcept {
  void* const memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr || bytes < kHeapLarge) return memory;
  char *const begin = static_cast<char*>(memory), *const heap_end = static_cast<char*>(sbrk(0));
  if (begin < heap_end)
    advise_heap(begin, heap_end);
  else if (bytes >= kMappedLarge)  // outside the heap: mapped by itself, or of another thread
    advise(begin, begin + bytes);
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* const memory = allocate(bytes)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
#endif
