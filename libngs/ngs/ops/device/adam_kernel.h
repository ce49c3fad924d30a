#pragma once
// Adam on a device: the step of ops/optim/adam_kernels.h per element, and the search for unusable gradients.
#include <limits>

#include "ngs/ops/device/sum_kernel.h"
#include "ngs/ops/optim/adam_kernels.h"

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

inline constexpr std::int64_t kNoIndex = std::numeric_limits<std::int64_t>::max();

/// The least index in each chunk of a value that is not finite or above the limit in magnitude.
struct FindUnusable {
  static constexpr const char* kName = "find_unusable";
  static constexpr std::int64_t kRows = 256;
  const float* value;
  std::int64_t n;
  float limit;
  std::int64_t* least;  // [chunks] out; kNoIndex: none
  NGS_HD void operator()(std::int64_t chunk) const {
    const InterleavedChunk rows(chunk, n, kRows);
    std::int64_t found = kNoIndex;
    for (std::int64_t i = rows.first; i < rows.end; i += rows.step)
      if (!(value[i] <= limit && -value[i] <= limit)) found = i < found ? i : found;
    least[chunk] = found;
  }
};

/// The least index of a value that is not finite or above `limit` in magnitude; -1 if none. `value` is
/// a device pointer.
template <class Launcher>
std::int64_t first_unusable_on_device(Launcher& launcher, const float* value, std::int64_t n, float limit) {
  if (n == 0) return -1;
  const std::int64_t chunks = ceil_div(n, FindUnusable::kRows);
  const DeviceBuffer<Launcher, std::int64_t> least(launcher, chunks);
  launcher.parallel_for(chunks, FindUnusable{value, n, limit, least.data()});
  const std::int64_t found = least_on_device(launcher, static_cast<const std::int64_t*>(least.data()), chunks);
  return found == kNoIndex ? -1 : found;
}

template <class Launcher>
void adam_on_device(Launcher& launcher, const AdamKernel<float>& kernel, std::int64_t sparse_columns) {
  if (sparse_columns > 0)
    launcher.parallel_for(kernel.n / sparse_columns, SparseAdamRow{{kernel, sparse_columns}});
  else
    launcher.parallel_for(kernel.n, AdamElement{kernel});
}

}  // namespace ngs
