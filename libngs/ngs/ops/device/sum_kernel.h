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

struct LeastOfChunk {
  static constexpr const char* kName = "least_of_chunk";
  static constexpr std::int64_t kRows = 256;
  const std::int64_t* value;  // [n], n > 0
  std::int64_t n;
  std::int64_t* least;  // [chunks] out
  NGS_HD void operator()(std::int64_t chunk) const {
    const InterleavedChunk rows(chunk, n, kRows);
    std::int64_t found = value[rows.first];
    for (std::int64_t row = rows.first; row < rows.end; row += rows.step)
      found = value[row] < found ? value[row] : found;
    least[chunk] = found;
  }
};

/// The least of n > 0 values in device memory.
template <class Launcher>
std::int64_t least_on_device(Launcher& launcher, const std::int64_t* value, std::int64_t n) {
  const std::int64_t chunks = ceil_div(n, LeastOfChunk::kRows);
  const DeviceBuffer<Launcher, std::int64_t> part(launcher, chunks);
  launcher.parallel_for(chunks, LeastOfChunk{value, n, part.data()});
  if (chunks > 1) return least_on_device(launcher, static_cast<const std::int64_t*>(part.data()), chunks);
  std::int64_t least = 0;
  part.to(&least);
  return least;
}

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
