#pragma once
// Sums over rows on a device: fixed chunks in double, their sums in order.
#include <vector>

#include "ngs/backend/grid.h"

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
    const std::int64_t first = i / columns * kRows, end = first + kRows < n ? first + kRows : n;
    double total = 0;
    for (std::int64_t row = first; row < end; ++row) total += double(value[row * columns + i % columns]);
    sum[i] = total;
  }
};

/// The sum of every column of `value` [n, columns], the grid's memory.
template <class T, class Grid>
std::vector<double> ordered_sums(Grid& grid, const T* value, std::int64_t n, int columns) {
  const std::int64_t chunks = divided_up(n, SumChunk<T>::kRows);
  const GridBuffer<Grid, double> part(grid, chunks * columns);
  grid.each(chunks * columns, SumChunk<T>{value, n, columns, part.data()});
  std::vector<double> host, total(std::size_t(columns), 0.0);
  part.to(host);
  for (std::size_t i = 0; i < host.size(); ++i) total[i % std::size_t(columns)] += host[i];
  return total;
}

}  // namespace ngs
