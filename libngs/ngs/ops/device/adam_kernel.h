#pragma once
// Adam on a device: the step of ops/optim/adam_kernels.h per element, and the search for unusable gradients.
#include <limits>

#include "ngs/ops/device/sum_kernel.h"
#include "ngs/ops/optim/adam_kernels.h"

namespace ngs {

inline constexpr std::int64_t kNoIndex = std::numeric_limits<std::int64_t>::max();

/// One element of the blocks; changes nothing if a gradient is unusable.
struct AdamElement {
  static constexpr const char* kName = "adam";
  AdamBlocks blocks;
  const std::int64_t* unusable;  // index of the first unusable gradient, or kNoIndex
  NGS_HD void operator()(std::int64_t element) const {
    if (*unusable != kNoIndex) return;
    const std::size_t b = blocks.of(element);
    const std::int64_t i = element - blocks.begin[b], columns = blocks.sparse_columns[b];
    bool touched = columns == 0;
    for (std::int64_t k = 0; k < columns; ++k)
      touched = touched || blocks.block[b].grad[i / columns * columns + k] != 0.f;
    if (touched) blocks.block[b].range(i, i + 1);
  }
};

/// The least index in each chunk of a gradient that is not finite or above the limit in magnitude.
struct FindUnusable {
  static constexpr const char* kName = "find_unusable";
  static constexpr std::int64_t kRows = 256;
  AdamBlocks blocks;
  float limit;
  std::int64_t* least;  // [chunks] out; kNoIndex: none
  NGS_HD void operator()(std::int64_t chunk) const {
    const InterleavedChunk rows(chunk, blocks.size(), kRows);
    std::int64_t found = kNoIndex;
    for (std::int64_t i = rows.first; i < rows.end; i += rows.step) {
      const std::size_t b = blocks.of(i);
      const float value = blocks.block[b].grad[i - blocks.begin[b]];
      if (!(value <= limit && -value <= limit)) found = i < found ? i : found;
    }
    least[chunk] = found;
  }
};

/// A step of all blocks, in device memory. Returns the index of the first unusable gradient, or kNoIndex: the host
/// waits for it after the step.
template <class Launcher>
std::int64_t adam_on_device(Launcher& launcher, const AdamBlocks& blocks, float limit) {
  if (blocks.size() == 0) return kNoIndex;
  const std::int64_t chunks = ceil_div(blocks.size(), FindUnusable::kRows);
  const DeviceBuffer<Launcher, std::int64_t> chunk(launcher, chunks), least(launcher, 1);
  launcher.parallel_for(chunks, FindUnusable{blocks, limit, chunk.data()});
  launcher.launch_blocks(1, LeastOfAll{chunk.data(), chunks, least.data()});
  launcher.parallel_for(blocks.size(), AdamElement{blocks, least.data()});
  std::int64_t found = kNoIndex;
  least.to(&found);
  return found;
}

}  // namespace ngs
