#pragma once
// Sums and minima over rows on a device. Sums are in double, by a tree reduction over fixed chunks, so their
// order is fixed.
#include <vector>

#include "ngs/backend/launcher.h"

namespace ngs {

/// Two levels of the tree: a thread sums a chunk of kRows rows, then one thread the chunks of its block.
template <class T>
struct SumChunks {
  static constexpr const char* kName = "sum_chunks";
  static constexpr std::int64_t kRows = 256;
  static constexpr int kThreads = kRows;
  const T* value;  // [n, columns]
  std::int64_t n;
  int columns;
  double* sum;  // [blocks, columns] out

  struct Shared {
    double chunk[kThreads];
  };
  struct Thread {};

  template <class Block>
  NGS_HD void operator()(Block& block) const {
    const std::int64_t all = ceil_div(n, kRows);
    const InterleavedChunk chunks(block.index, all, kRows);
    for (int c = 0; c < columns; ++c) {
      block.phase([&](int t, Shared& shared, Thread&) {
        const std::int64_t chunk = chunks.first + t * chunks.step;
        double total = 0;
        const InterleavedChunk rows(chunk < chunks.end ? chunk : 0, n, kRows);
        for (std::int64_t row = rows.first; chunk < chunks.end && row < rows.end; row += rows.step)
          total += double(value[row * columns + c]);
        shared.chunk[t] = total;
      });
      block.phase([&](int t, Shared& shared, Thread&) {
        if (t > 0) return;
        double total = 0;
        std::int64_t chunk = chunks.first;
        for (int k = 0; chunk < chunks.end; ++k, chunk += chunks.step) total += shared.chunk[k];
        sum[block.index * columns + c] = total;
      });
    }
  }
};

/// total[c] = the sum of column c of `value` [n, columns]. All pointers are device pointers.
template <class T, class Launcher>
void sums_on_device(Launcher& launcher, const T* value, std::int64_t n, int columns, double* total) {
  constexpr std::int64_t kRows = SumChunks<T>::kRows;
  const std::int64_t blocks = ceil_div(ceil_div(n, kRows), kRows);
  if (blocks <= 1) return launcher.launch_blocks(1, SumChunks<T>{value, n, columns, total});
  const DeviceBuffer<Launcher, double> part(launcher, blocks * columns);
  launcher.launch_blocks(blocks, SumChunks<T>{value, n, columns, part.data()});
  sums_on_device(launcher, static_cast<const double*>(part.data()), blocks, columns, total);
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
