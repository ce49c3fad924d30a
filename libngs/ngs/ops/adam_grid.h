#pragma once
// Adam on a device: the step of ops/adam_kernels.h element by element, and the search for gradients that it cannot take.
#include "ngs/backend/grid.h"
#include "ngs/ops/adam_kernels.h"

namespace ngs {

struct AdamElement {
  static constexpr const char* kName = "adam";
  AdamKernel<float> kernel;
  NGS_HD void operator()(std::int64_t i) const { kernel.range(i, i + 1); }
};

struct SparseAdamRow {
  static constexpr const char* kName = "adam_rows";
  SparseAdamKernel<float> kernel;
  NGS_HD void operator()(std::int64_t row) const { kernel(row); }
};

/// The first index in each chunk whose value is not finite or above the limit; -1: none.
struct FindUnusable {
  static constexpr const char* kName = "find_unusable";
  static constexpr std::int64_t kChunk = 256;
  const float* value;
  std::int64_t n;
  float limit;
  std::int64_t* first;  // [chunks] out
  NGS_HD void operator()(std::int64_t chunk) const {
    const std::int64_t begin = chunk * kChunk, end = begin + kChunk < n ? begin + kChunk : n;
    first[chunk] = -1;
    for (std::int64_t i = end; i-- > begin;)
      if (!(value[i] <= limit && -value[i] <= limit)) first[chunk] = i;
  }
};

/// The first of the found ones of every group of chunks.
struct FirstFound {
  static constexpr const char* kName = "first_found";
  static constexpr std::int64_t kChunk = 1024;
  const std::int64_t* found;
  std::int64_t n;
  std::int64_t* first;  // [chunks] out
  NGS_HD void operator()(std::int64_t chunk) const {
    const std::int64_t begin = chunk * kChunk, end = begin + kChunk < n ? begin + kChunk : n;
    std::int64_t at = begin;
    while (at < end && found[at] < 0) ++at;
    first[chunk] = at < end ? found[at] : -1;
  }
};

/// Index of the first unusable value, -1 if none.
template <class Grid>
std::int64_t first_unusable_on_grid(Grid& grid, const float* value, std::int64_t n, float limit) {
  const std::int64_t chunks = divided_up(n, FindUnusable::kChunk), groups = divided_up(chunks, FirstFound::kChunk);
  const GridBuffer<Grid, std::int64_t> found(grid, chunks), first(grid, groups);
  grid.each(chunks, FindUnusable{value, n, limit, found.data()});
  grid.each(groups, FirstFound{found.data(), chunks, first.data()});
  std::vector<std::int64_t> host;
  first.to(host);
  for (const std::int64_t i : host)
    if (i >= 0) return i;
  return -1;
}

template <class Grid>
void adam_on_grid(Grid& grid, const AdamKernel<float>& kernel, std::int64_t sparse_columns) {
  if (sparse_columns > 0)
    grid.each(kernel.n / sparse_columns, SparseAdamRow{{kernel, sparse_columns}});
  else
    grid.each(kernel.n, AdamElement{kernel});
}

}  // namespace ngs
