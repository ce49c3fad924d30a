#pragma once
// Counts the finished work items of a step from several threads and reports each to a monitor.
#include <mutex>

#include "ngs/core/monitor.h"

namespace ngs {

class ProgressCount {
 public:
  ProgressCount(Monitor& monitor, std::int64_t total) : monitor_(monitor), total_(total) {}
  void add_one() {
    const std::lock_guard lock(mutex_);
    monitor_.progress(++done_, total_);
  }

 private:
  Monitor& monitor_;
  std::mutex mutex_;
  std::int64_t done_ = 0, total_;
};

}  // namespace ngs
