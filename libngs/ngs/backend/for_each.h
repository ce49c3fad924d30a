#pragma once
// Parallel loops on the CPU: the one place that runs map-type kernels.
#include <omp.h>

#include <exception>
#include <limits>
#include <mutex>

#include "ngs/backend/exec.h"

namespace ngs {

/// Carries an exception out of a parallel region, which no exception may leave directly.
class FirstFailure {
 public:
  /// Stores the exception in flight, thrown at index i, unless one of a smaller index is stored.
  void keep(std::int64_t i) {
    const std::lock_guard lock(mutex_);
    if (i < first_) {
      first_ = i;
      failure_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::mutex mutex_;
  std::int64_t first_ = std::numeric_limits<std::int64_t>::max();
  std::exception_ptr failure_;
};

/// kernel(i) for every i in [0, n), in no particular order. A kernel writes only what index i owns (gather, never
/// scatter), so the result depends neither on the order nor on the thread count. If kernels throw (out of memory, for
/// example), one of the exceptions is rethrown, and some i may not have been visited.
template <class Kernel>
void for_each_index(const Exec& exec, std::int64_t n, const Kernel& kernel) {
  FirstFailure failure;
#pragma omp parallel num_threads(exec.threads)
  {
    const std::int64_t threads = omp_get_num_threads(), thread = omp_get_thread_num();
    const std::int64_t begin = n / threads * thread + n % threads * thread / threads,
                       end = n / threads * (thread + 1) + n % threads * (thread + 1) / threads;
    try {  // around the loop, so that the loop still vectorises
      for (std::int64_t i = begin; i < end; ++i) kernel(i);
    } catch (...) {
      failure.keep(begin);
    }
  }
  failure.rethrow();
}

/// The same for few, unequal work items (tiles, views), handed out one by one. All are visited even if one throws; then
/// the exception of the smallest i is rethrown, for any number of threads.
template <class Kernel>
void for_each_task(const Exec& exec, std::int64_t n, const Kernel& kernel) {
  FirstFailure failure;
#pragma omp parallel for schedule(dynamic, 1) num_threads(exec.threads)
  for (std::int64_t i = 0; i < n; ++i) {
    try {
      kernel(i);
    } catch (...) {
      failure.keep(i);
    }
  }
  failure.rethrow();
}

}  // namespace ngs
