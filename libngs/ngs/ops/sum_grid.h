#pragma once
// Sums over rows on a device, in double: fixed chunks, whose sums are summed in fixed chunks, and so on.
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

/// total[c] = the sum of column c of `value` [n, columns]; all of it the grid's memory.
template <class T, class Grid>
void sums_on_grid(Grid& grid, const T* value, std::int64_t n, int columns, double* total) {
  const std::int64_t chunks = divided_up(n, SumChunk<T>::kRows);
  if (chunks <= 1) return grid.each(columns, SumChunk<T>{value, n, columns, total});
  const GridBuffer<Grid, double> part(grid, chunks * columns);
  grid.each(chunks * columns, SumChunk<T>{value, n, columns, part.data()});
  sums_on_grid(grid, static_cast<const double*>(part.data()), chunks, columns, total);
}

/// The same on the host.
template <class T, class Grid>
std::vector<double> ordered_sums(Grid& grid, const T* value, std::int64_t n, int columns) {
  const GridBuffer<Grid, double> total(grid, columns);
  sums_on_grid(grid, value, n, columns, total.data());
  std::vector<double> host;
  total.to(host);
  return host;
}

}  // namespace ngs
