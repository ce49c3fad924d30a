#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "ngs/backend/cuda_launcher.cuh"

namespace ngs {
namespace {

struct AddWide {
  NGS_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

}  // namespace

void CudaLauncher::sort(std::uint64_t* keys, std::uint32_t* values, std::int64_t n, int bits) {
  if (n <= 1) return;
  const DeviceBuffer<CudaLauncher, std::uint64_t> other_keys(*this, n);
  const DeviceBuffer<CudaLauncher, std::uint32_t> other_values(*this, n);
  cub::DoubleBuffer<std::uint64_t> k(keys, other_keys.data());
  cub::DoubleBuffer<std::uint32_t> v(values, other_values.data());
  std::size_t bytes = 0;
  check_cuda(cub::DeviceRadixSort::SortPairs(nullptr, bytes, k, v, n, 0, bits, stream()), "sort");
  const DeviceBuffer<CudaLauncher, char> scratch(*this, std::int64_t(bytes));
  detail::KernelClock clock("sort", stream());
  check_cuda(cub::DeviceRadixSort::SortPairs(scratch.data(), bytes, k, v, n, 0, bits, stream()), "sort");
  clock.stop();
  if (k.Current() != keys) copy(keys, k.Current(), std::size_t(n) * sizeof *keys);
  if (v.Current() != values) copy(values, v.Current(), std::size_t(n) * sizeof *values);
}

void CudaLauncher::exclusive_scan(const std::uint32_t* in, std::int64_t* out, std::int64_t n) {
  fill_zero(out, sizeof *out);
  if (n == 0) return;
  std::size_t bytes = 0;
  const auto sum = [&](void* scratch) {
    return cub::DeviceScan::InclusiveScan(scratch, bytes, in, out + 1, AddWide{}, n, stream());
  };
  check_cuda(sum(nullptr), "sum");
  const DeviceBuffer<CudaLauncher, char> scratch(*this, std::int64_t(bytes));
  detail::KernelClock clock("sum", stream());
  check_cuda(sum(scratch.data()), "sum");
  clock.stop();
}

}  // namespace ngs
