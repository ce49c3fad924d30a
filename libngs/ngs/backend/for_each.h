#pragma once
// The one place that runs map-type kernels.
#include "ngs/backend/exec.h"

namespace ngs {

/// kernel(i) for every i in [0, n), in no particular order. A kernel writes only what index i owns (gather,
/// never scatter), so the result depends neither on the order nor on the thread count.
template <class Kernel>
void for_each_index(const Exec& exec, std::int64_t n, const Kernel& kernel) {
#pragma omp parallel for schedule(static) num_threads(exec.threads)
  for (std::int64_t i = 0; i < n; ++i) kernel(i);
}

/// The same for few, unequal pieces of work (tiles, views): handed out one by one.
template <class Kernel>
void for_each_task(const Exec& exec, std::int64_t n, const Kernel& kernel) {
#pragma omp parallel for schedule(dynamic, 1) num_threads(exec.threads)
  for (std::int64_t i = 0; i < n; ++i) kernel(i);
}

}  // namespace ngs
