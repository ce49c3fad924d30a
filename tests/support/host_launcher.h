#pragma once
// Emulates the Launcher of backend/launcher.h on the host: blocks run one after the other, and in every phase thread
// after thread. Finds device errors without a device:
// clang-format off
//   reads of uninitialised memory    allocations, Shared and Thread start as NaN / all bits set
//   races in a phase or launch       results must not depend on `order` (ascending, descending, shuffled)
//   accesses out of bounds           the address sanitizer knows the exact size of allocations
//   accesses by host code            guarded device memory faults outside of launches and copies
//   too little memory                allocations fail after a given number of them
// clang-format on
// Counts launches and copies.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numeric>

#include "ngs/backend/launcher.h"
#include "ngs/core/check.h"
#include "ngs/core/rng.h"
#include "support/guarded_memory.h"

namespace ngs::test {

/// What a device had to do. A sort, a scan, a fill and a copy within the device count as one launch each.
struct Traffic {
  std::int64_t launches = 0, copies = 0, allocations = 0;
  std::size_t up_bytes = 0, down_bytes = 0, largest_copy_bytes = 0;
};

enum class ThreadOrder { kAscending, kDescending, kShuffled };

template <class Kernel>
class HostBlock {
 public:
  HostBlock(std::int64_t block, const std::vector<int>& order)
      : index(block), order_(order), shared_(std::make_unique<Shared>()), own_(order.size()) {
    static_assert(std::is_trivially_copyable_v<Shared> && std::is_trivially_copyable_v<Thread>);
    std::memset(static_cast<void*>(shared_.get()), 0xff, sizeof(Shared));
    std::memset(static_cast<void*>(own_.data()), 0xff, sizeof(Thread) * own_.size());
  }
  template <class F>
  void phase(const F& f) {
    for (const int t : order_) f(t, *shared_, own_[std::size_t(t)]);
  }
  template <class F>
  bool any(const F& f) {
    bool some = false;
    for (const int t : order_) some = f(t, *shared_, own_[std::size_t(t)]) || some;
    return some;
  }
  template <class F>
  void each(const F& f) {
    for (const int t : order_) f(t, std::as_const(*shared_), own_[std::size_t(t)]);
  }
  template <class Test, class Take>
  void ballot(const Test& test, const Take& take) {
    std::vector<std::uint32_t> bits(order_.size() / kWarpThreads);
    for (const int t : order_)
      bits[std::size_t(t / kWarpThreads)] |= std::uint32_t(test(t, std::as_const(*shared_))) << t % kWarpThreads;
    for (const int t : order_) take(own_[std::size_t(t)], bits[std::size_t(t / kWarpThreads)]);
  }
  std::int64_t index;

 private:
  using Shared = typename Kernel::Shared;
  using Thread = typename Kernel::Thread;
  const std::vector<int>& order_;
  std::unique_ptr<Shared> shared_;
  std::vector<Thread> own_;
};

class HostLauncher {
 public:
  static constexpr bool kSpoilsHost = true;  // the host's values of resident arrays: all bits set
  ResidentTable resident;

  explicit HostLauncher(ThreadOrder order = ThreadOrder::kAscending, bool guarded = false)
      : order_(order), memory_(guarded) {}
  static void atomic_add(float* to, float x) { *to += x; }
  HostLauncher(const HostLauncher&) = delete;
  HostLauncher& operator=(const HostLauncher&) = delete;
  ~HostLauncher() {
    if (!memory_.empty()) std::abort();  // a leak
  }
  Traffic& traffic() { return traffic_; }
  /// The device has memory for so many more allocations; negative: for any number.
  void limit_allocations(std::int64_t more) { allocations_left_ = more; }

  template <class Kernel>
  void parallel_for(std::int64_t n, const Kernel& kernel) {
    static_assert(sizeof(Kernel) <= 4096 && std::is_trivially_copyable_v<Kernel>, "a kernel is passed by value");
    NGS_CHECK(Kernel::kName != nullptr, "a kernel has a name");
    const Launch launch(*this, n);
    for (const int i : sequence(n)) kernel(i);
  }
  template <class Kernel>
  void launch_blocks(std::int64_t n, const Kernel& kernel) {
    static_assert(sizeof(Kernel) <= 4096 && std::is_trivially_copyable_v<Kernel>, "a kernel is passed by value");
    static_assert(sizeof(typename Kernel::Shared) <= 48 * 1024);
    NGS_CHECK(Kernel::kName != nullptr, "a kernel has a name");
    const Launch launch(*this, n);
    const std::vector<int> threads = sequence(Kernel::kThreads);
    for (const int index : sequence(n)) {
      HostBlock<Kernel> block(index, threads);
      kernel(block);
    }
  }
  void sort(std::uint64_t* keys, std::uint32_t* values, std::int64_t n, int bits) {
    const Launch launch(*this, n);
    const std::uint64_t mask = bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> pairs;
    for (std::int64_t i = 0; i < n; ++i) pairs.emplace_back(keys[i], values[i]);
    std::stable_sort(pairs.begin(), pairs.end(), [&](auto a, auto b) { return (a.first & mask) < (b.first & mask); });
    for (std::int64_t i = 0; i < n; ++i) {
      keys[i] = pairs[std::size_t(i)].first;
      values[i] = pairs[std::size_t(i)].second;
    }
  }
  void exclusive_scan(const std::uint32_t* in, std::int64_t* out, std::int64_t n) {
    const Launch launch(*this, n + 1);
    out[0] = 0;
    for (std::int64_t i = 0; i < n; ++i) out[i + 1] = out[i] + in[i];
  }
  void* allocate(std::size_t bytes) {
    if (allocations_left_ == 0) throw_out_of_device_memory(bytes);
    if (allocations_left_ > 0) --allocations_left_;
    ++traffic_.allocations;
    return memory_.allocate(bytes);
  }
  void release(void* memory) noexcept { memory_.release(memory); }
  void upload(void* device, const void* host, std::size_t bytes) {
    count_copy(bytes, traffic_.up_bytes);
    const GuardedMemory::Access access(memory_);
    std::memcpy(device, host, bytes);
  }
  void download(void* host, const void* device, std::size_t bytes) {
    count_copy(bytes, traffic_.down_bytes);
    const GuardedMemory::Access access(memory_);
    std::memcpy(host, device, bytes);
  }
  void copy(void* to, const void* from, std::size_t bytes) {
    const Launch launch(*this, 1);
    std::memcpy(to, from, bytes);
  }
  void fill_zero(void* device, std::size_t bytes) {
    const Launch launch(*this, 1);
    std::memset(device, 0, bytes);
  }

 private:
  /// Kernels run while it exists.
  struct Launch {
    GuardedMemory::Access access;
    Launch(HostLauncher& launcher, std::int64_t n) : access(launcher.memory_) { launcher.traffic_.launches += n > 0; }
  };
  void count_copy(std::size_t bytes, std::size_t& total) {
    ++traffic_.copies;
    total += bytes;
    traffic_.largest_copy_bytes = std::max(traffic_.largest_copy_bytes, bytes);
  }
  std::vector<int> sequence(std::int64_t n) const {
    std::vector<int> order(std::size_t(std::max<std::int64_t>(n, 0)));
    std::iota(order.begin(), order.end(), 0);
    if (order_ == ThreadOrder::kDescending) std::reverse(order.begin(), order.end());
    if (order_ == ThreadOrder::kShuffled)
      for (std::size_t i = order.size(); i-- > 1;)
        std::swap(order[i], order[rng_bits(5, RngStream::kTest, i) % (i + 1)]);
    return order;
  }
  ThreadOrder order_;
  GuardedMemory memory_;
  Traffic traffic_;
  std::int64_t allocations_left_ = -1;
};

}  // namespace ngs::test
