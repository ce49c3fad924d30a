// The calls that Clang makes of the parallel regions in ngs/backend/for_each.h, for a browser, for which there is no
// OpenMP: teams of threads that wait between regions. A region within a region runs in the thread that meets it.
#include "omp.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <thread>

namespace {

constexpr int kMostArguments = 8;  // variables of a region

struct Region {
  void (*run)();
  int arguments, threads;
  void* argument[kMostArguments];
  std::atomic<std::int64_t> next;  // index of a loop

  void run_as(std::int32_t thread) {
    using P = std::int32_t*;
    using V = void*;
    V* a = argument;
    const auto call = [&](auto... more) {
      reinterpret_cast<void (*)(P, P, decltype(more)...)>(run)(&thread, &thread, more...);
    };
    switch (arguments) {  // WebAssembly calls a function with the number of arguments that it has
      case 0: return call();
      case 1: return call(a[0]);
      case 2: return call(a[0], a[1]);
      case 3: return call(a[0], a[1], a[2]);
      case 4: return call(a[0], a[1], a[2], a[3]);
      case 5: return call(a[0], a[1], a[2], a[3], a[4]);
      case 6: return call(a[0], a[1], a[2], a[3], a[4], a[5]);
      case 7: return call(a[0], a[1], a[2], a[3], a[4], a[5], a[6]);
      case 8: return call(a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7]);
      default: std::abort();
    }
  }
};

struct Place {
  Region* region = nullptr;
  int thread = 0, wanted = 1;
  std::int64_t last = 0;  // of the loop
};
thread_local Place here;

void run_here(Region& region, int thread) {
  const Place outside = here;
  here.region = &region;
  here.thread = thread;
  region.run_as(thread);
  here = outside;
}

class Team {
 public:
  int most = 1;

  void run(Region& region) {
    {
      const std::lock_guard lock(mutex_);
      for (; started_ < most - 1; ++started_) std::thread([this, thread = started_ + 1] { work(thread); }).detach();
      region_ = &region;
      threads_ = region.threads;
      running_ = threads_ - 1;
      ++count_;
    }
    begin_.notify_all();
    run_here(region, 0);
    std::unique_lock lock(mutex_);
    end_.wait(lock, [&] { return running_ == 0; });
  }

 private:
  [[noreturn]] void work(int thread) {
    for (std::uint64_t seen = 0;;) {
      std::unique_lock lock(mutex_);
      begin_.wait(lock, [&] { return count_ != seen; });
      seen = count_;
      if (thread >= threads_) continue;  // *region_ may be gone
      Region& region = *region_;
      lock.unlock();
      run_here(region, thread);
      lock.lock();
      if (--running_ == 0) end_.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable begin_, end_;
  Region* region_ = nullptr;
  int started_ = 0, threads_ = 0, running_ = 0;
  std::uint64_t count_ = 0;  // of regions
};

Team& team() {
  static Team& only = *new Team;  // lives as long as its threads
  return only;
}

}  // namespace

extern "C" {

int omp_get_num_threads() { return here.region == nullptr ? 1 : here.region->threads; }
int omp_get_thread_num() { return here.thread; }
int omp_get_max_threads() { return team().most; }
void omp_set_num_threads(int threads) { team().most = std::max(1, threads); }

std::int32_t __kmpc_global_thread_num(void*) { return here.thread; }
void __kmpc_push_num_threads(void*, std::int32_t, std::int32_t threads) { here.wanted = threads; }

void __kmpc_fork_call(void*, std::int32_t arguments, void (*run)(), ...) {
  Region region{run, arguments, here.region != nullptr ? 1 : std::clamp(here.wanted, 1, team().most), {}, {}};
  std::va_list list;
  va_start(list, run);
  for (int i = 0; i < std::min(arguments, kMostArguments); ++i) region.argument[i] = va_arg(list, void*);
  va_end(list);
  region.threads == 1 ? run_here(region, 0) : team().run(region);
}

// Of loops of schedule(dynamic, 1) from 0.
void __kmpc_dispatch_init_8(void*, std::int32_t, std::int32_t, std::int64_t, std::int64_t last, std::int64_t,
                            std::int64_t) {
  here.last = last;
}
std::int32_t __kmpc_dispatch_next_8(void*, std::int32_t, std::int32_t* is_last, std::int64_t* begin, std::int64_t* end,
                                    std::int64_t* step) {
  const std::int64_t i = here.region->next++;
  *begin = *end = i;
  *step = 1;
  *is_last = i == here.last;
  return i <= here.last;
}

}  // extern "C"
