#include <algorithm>
#include <map>

#include "ngs/backend/cuda_launcher.cuh"
#include "ngs/backend/device_profile.h"

namespace ngs {
namespace {

struct Profile {
  bool on = false;
  std::map<std::string, KernelTime> kernel;
};
Profile& profile() {
  static Profile instance;
  return instance;
}

}  // namespace

namespace detail {

KernelClock::KernelClock(const char* name, cudaStream_t stream) : name_(name), stream_(stream) {
  if (!profile().on) return;
  check_cuda(cudaEventCreate(&begin_), "event");
  check_cuda(cudaEventRecord(begin_, stream_), "event");
}

void KernelClock::stop() {
  if (begin_ == nullptr) return;
  cudaEvent_t end;
  float milliseconds = 0;
  check_cuda(cudaEventCreate(&end), "event");
  check_cuda(cudaEventRecord(end, stream_), "event");
  check_cuda(cudaEventSynchronize(end), name_);
  check_cuda(cudaEventElapsedTime(&milliseconds, begin_, end), "event");
  cudaEventDestroy(begin_);
  cudaEventDestroy(end);
  KernelTime& time = profile().kernel[name_];
  time.name = name_;
  ++time.launches;
  time.seconds += 1e-3 * double(milliseconds);
}

}  // namespace detail

void profile_device() {
  profile().kernel.clear();
  profile().on = true;
}

std::vector<KernelTime> device_times() {
  profile().on = false;
  std::vector<KernelTime> times;
  for (const auto& [name, time] : profile().kernel) times.push_back(time);
  return times;
}

double device_copy_bandwidth(std::size_t bytes) {
  void *from = nullptr, *to = nullptr;
  check_cuda(cudaMalloc(&from, bytes), "memory");
  check_cuda(cudaMalloc(&to, bytes), "memory");
  check_cuda(cudaMemset(from, 1, bytes), "fill");
  double best = 0;
  for (int round = 0; round < 10; ++round) {
    cudaEvent_t begin, end;
    float milliseconds = 0;
    check_cuda(cudaEventCreate(&begin), "event");
    check_cuda(cudaEventCreate(&end), "event");
    check_cuda(cudaEventRecord(begin), "event");
    check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice), "copy");
    check_cuda(cudaEventRecord(end), "event");
    check_cuda(cudaEventSynchronize(end), "copy");
    check_cuda(cudaEventElapsedTime(&milliseconds, begin, end), "event");
    cudaEventDestroy(begin);
    cudaEventDestroy(end);
    best = std::max(best, 2.0 * double(bytes) / (1e-3 * double(milliseconds)));
  }
  cudaFree(from);
  cudaFree(to);
  return best;
}

}  // namespace ngs
