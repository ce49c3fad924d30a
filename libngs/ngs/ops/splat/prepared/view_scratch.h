#pragma once
// Scratch memory for rendering one view, reused for the next: fresh pages cost as much to fault in as the data to
// write.
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "ngs/ops/splat/tile_lists.h"

namespace ngs {

template <class S>
struct ViewScratch {
  ProjectedView<S> view;
  TileLists lists;
  BinScratch bins;
  std::vector<std::uint8_t> reaches;  // [rows] 1: the Gaussian may reach a pixel
  std::vector<std::int64_t> first;    // [blocks + 1] first row of ProjectedView per block
  std::vector<S> sums;                // per-pair sums of the pass
};

/// Pool of ViewScratch. Holds as many as were ever in use at once. Thread-safe.
class ViewScratchPool {
 public:
  std::unique_ptr<ViewScratch<float>> acquire() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<ViewScratch<float>>();
    std::unique_ptr<ViewScratch<float>> memory = std::move(free_.back());
    free_.pop_back();
    return memory;
  }
  void release(std::unique_ptr<ViewScratch<float>> memory) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(memory));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<ViewScratch<float>>> free_;
};

}  // namespace ngs
