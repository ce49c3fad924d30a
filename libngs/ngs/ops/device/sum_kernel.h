#pragma once
// Sums and minima over rows on a device. Sums are in double, by a tree reduction over fixed chunks, so their
// order is fixed.
#include <vector>

#include "ngs/backend/launcher.h"

namespace ngs {

template <class T>
struct SumChunk {
  static constexpr const char* kName = "sum_chunk";
  static constexpr std::int64_t kRows = 256;
  const T* value;  // [n, columns]
  std::int64_t n;
  int columns;
  double* sum;  // [chunks, columns] out

  NGS_HD void operator()(std::int64_t i) const {
    const InterleavedChunk rows(i / columns, n, kRows);
    double total = 0;
    for (std::int64_t row = rows.first; row < rows.end; row += rows.step)
      total += double(value[row * columns + i % columns]);
    sum[i] = total;
  }
};

/// total[c] = the sum of column c of `value` [n, columns]. All pointers are device pointers.
template <class T, class Launcher>
void sums_on_device(Launcher& launcher, const T* value, std::int64_t n, int columns, double* total) {
  const std::int64_t chunks = ceil_div(n, SumChunk<T>::kRows);
  if (chunks <= 1) return launcher.parallel_for(columns, SumChunk<T>{value, n, columns, total});
  const DeviceBuffer<Launcher, double> part(launcher, chunks * columns);
  launcher.parallel_for(chunks * columns, SumChunk<T>{value, n, columns, part.data()});
  sums_on_device(launcher, static_cast<const double*>(part.data()), chunks, columns, total);
}

/// The least of n > 0 values, by one block.
struct LeastOfAll {
  static constexpr const char* kName = "least_of_all";
  static constexpr int kThreads = 256;
  const std::int64_t* value;  // [n]
  std::int64_t n;
  std::int64_t* least;  // [1] out
  struct Shared {
    std::int64_t found[kThreads];
  };
  struct Thread {};

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    block.phase([&](int t, Shared& shared, Thread&) {
      std::int64_t found = value[t < n ? t : 0];
      for (std::int64_t i = t; i < n; i += kThreads) found = value[i] < found ? value[i] : found;
      shared.found[t] = found;
    });
    block.phase([&](int t, Shared& shared, Thread&) {
      if (t > 0) return;
      std::int64_t found = shared.found[0];
      for (const std::int64_t other : shared.found) found = other < found ? other : found;
      *least = found;
    });
  }
};

/// The sums of all columns, copied to the host.
template <class T, class Launcher>
std::vector<double> ordered_sums(Launcher& launcher, const T* value, std::int64_t n, int columns) {
  const DeviceBuffer<Launcher, double> total(launcher, columns);
  sums_on_device(launcher, value, n, columns, total.data());
  std::vector<double> host;
  total.to(host);
  return host;
}

}  // namespace ngs
