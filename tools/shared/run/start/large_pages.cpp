// Columns of millions of rows use pages of 2 MiB if the system has them: large allocations are aligned to such pages,
// and the kernel is advised to use them (transparent huge pages). This saves 511 of 512 page faults: with 2e7
// Gaussians, page faults take a quarter of a draft run (decisions/077). Smaller allocations are those of the C library.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kPage = std::size_t(2) << 20, kLarge = 2 * kPage;  // bytes

void* allocate(std::size_t bytes) noexcept {
  if (bytes < kLarge) return std::malloc(bytes == 0 ? 1 : bytes);
  void* const memory = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
  if (memory != nullptr) madvise(memory, bytes, MADV_HUGEPAGE);
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
