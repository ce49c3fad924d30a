#pragma once
// Prefetching of memory that the hardware prefetcher does not predict.
#include <cstdint>

namespace ngs {

/// Fetches `count` values into the caches. Always inlined: GCC drops calls of a function without effects.
template <class T>
[[gnu::always_inline]] inline void prefetch_values(const T* first, std::int64_t count) {
  constexpr std::int64_t kLine = sizeof(T) < 64 ? 64 / sizeof(T) : 1;
  for (std::int64_t i = 0; i < count; i += kLine) __builtin_prefetch(first + i);
}

}  // namespace ngs
