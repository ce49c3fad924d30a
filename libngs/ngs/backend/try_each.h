#pragma once
// for_each_task for work that may throw: no exception may leave a parallel region.
#include <exception>
#include <vector>

#include "ngs/backend/for_each.h"

namespace ngs {

/// kernel(i) for every i in [0, n), all of them even if one throws; then the exception of the smallest i is
/// thrown, for any number of threads the same.
template <class Kernel>
void try_each_task(const Exec& exec, std::int64_t n, const Kernel& kernel) {
  std::vector<std::exception_ptr> failed(static_cast<std::size_t>(n));
  for_each_task(exec, n, [&](std::int64_t i) {
    try {
      kernel(i);
    } catch (...) {
      failed[static_cast<std::size_t>(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& e : failed)
    if (e) std::rethrow_exception(e);
}

}  // namespace ngs
