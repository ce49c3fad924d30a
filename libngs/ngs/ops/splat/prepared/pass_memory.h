#pragma once
// Scratch memory of a pass over one view, reused for the next view: fresh pages cost as much as writing the data.
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
  std::vector<std::int64_t> first;    // [blocks + 1] first row of ProjectedView per block
  std::vector<S> sums;                // per-pair sums of the pass
};

/// A pool of PassMemory; holds as many as passes have run at the same time. Thread-safe.
class PassMemoryPool {
 public:
  std::unique_ptr<PassMemory<float>> acquire() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<PassMemory<float>>();
    std::unique_ptr<PassMemory<float>> memory = std::move(free_.back());
    free_.pop_back();
    return memory;
  }
  void release(std::unique_ptr<PassMemory<float>> memory) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(memory));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<PassMemory<float>>> free_;
};

}  // namespace ngs
