#pragma once
// Memory of a pass over a view that is kept for the next view: fresh pages cost as much as what is written to them.
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "ngs/ops/splat/tile_lists.h"

namespace ngs {

template <class S>
struct PassMemory {
  ProjectedView<S> view;
  TileLists lists;
  BinScratch bins;
  std::vector<std::uint8_t> reaches;  // [rows] 1: the Gaussian may reach a pixel
  std::vector<std::int64_t> first;    // [blocks + 1] the first row of ProjectedView that a block writes
  std::vector<S> sums;                // of pairs, whatever the pass sums
};

/// Hands out the memory of passes over floats; as many exist as passes run at a time.
class PassMemoryPool {
 public:
  std::unique_ptr<PassMemory<float>> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<PassMemory<float>>();
    std::unique_ptr<PassMemory<float>> memory = std::move(free_.back());
    free_.pop_back();
    return memory;
  }
  void give_back(std::unique_ptr<PassMemory<float>> memory) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(memory));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<PassMemory<float>>> free_;
};

}  // namespace ngs
