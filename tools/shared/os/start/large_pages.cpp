// Columns of millions of rows use pages of 2 MiB if the system has them: large allocations are aligned to such pages,
// and the kernel is advised to use them (transparent huge pages). This saves 511 of 512 page faults: with 2e7
// Gaussians, page faults take a quarter of a draft run (decision 077). Smaller allocations are those of the C library.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kPage = 4096, kLarge = std::size_t(4) << 20;  // bytes

void* allocate(std::size_t bytes) noexcept {
  void* const memory = std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr || bytes < kLarge) return memory;
  const std::uintptr_t begin = (std::uintptr_t(memory) + kPage - 1) / kPage * kPage;
  const std::uintptr_t end = (std::uintptr_t(memory) + bytes) / kPage * kPage;
  madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // without effect where there are none
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
