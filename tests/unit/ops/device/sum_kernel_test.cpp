#include "ngs/ops/device/sum_kernel.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/ops/device/adam_kernel.h"
#include "support/host_launcher.h"

namespace ngs {

namespace {

// Around the size of a chunk, and of a group of 32 interleaved chunks.
constexpr std::int64_t kSizes[] = {1, 2, 255, 256, 257, 511, 8191, 8192, 8193, 70000};

}  // namespace

TEST_CASE("interleaved chunks cover every row once, and neighbouring chunks start at neighbouring rows") {
  for (const std::int64_t n : kSizes) {
    CAPTURE(n);
    std::vector<int> times(static_cast<std::size_t>(n));
    const std::int64_t chunks = ceil_div<std::int64_t>(n, 256);
    for (std::int64_t chunk = 0; chunk < chunks; ++chunk) {
      const InterleavedChunk rows(chunk, n, 256);
      std::int64_t count = 0;
      for (std::int64_t row = rows.first; row < rows.end; row += rows.step) ++times[std::size_t(row)], ++count;
      CHECK(count <= 256);
      if (chunk % 32 > 0) CHECK(rows.first == InterleavedChunk(chunk - 1, n, 256).first + 1);
    }
    CHECK(std::count(times.begin(), times.end(), 1) == n);
  }
}

TEST_CASE("ordered_sums equals the sum of all rows for every number of chunks") {
  test::HostLauncher launcher;
  for (const std::int64_t n : kSizes)
    for (const int columns : {1, 3}) {
      CAPTURE(n);
      std::vector<float> value;
      std::vector<double> want(std::size_t(columns), 0.0);
      for (std::int64_t i = 0; i < n * columns; ++i) {
        value.push_back(float(i % 1013) - 500.f);  // sums are whole numbers
        want[std::size_t(i % columns)] += double(value.back());
      }
      const DeviceBuffer<test::HostLauncher, float> on_device(launcher, value);
      CHECK(ordered_sums(launcher, static_cast<const float*>(on_device.data()), n, columns) == want);
    }
}

TEST_CASE("adam_on_device finds the first gradient above the limit in any block, and then changes nothing") {
  test::HostLauncher launcher;
  for (const std::int64_t n : kSizes)
    for (const std::int64_t bad : {std::int64_t(0), n / 3, n / 2, n - 1}) {
      CAPTURE(n);
      CAPTURE(bad);
      std::vector<float> grad(std::size_t(n), 1.f);
      const std::vector<float> zero(std::size_t(n), 0.f);
      const auto first = [&](float want_value) {
        const DeviceBuffer<test::HostLauncher, float> g(launcher, grad), value(launcher, zero), m(launcher, zero),
            v(launcher, zero);
        AdamBlocks blocks;  // two blocks, cut in the middle
        const auto add = [&](std::int64_t begin, std::int64_t size) {
          blocks.add({value.data() + begin, g.data() + begin, m.data() + begin, v.data() + begin, size, 1.f, 1.f, 1.f,
                      1.f, 0.f},
                     0);
        };
        add(0, n / 2), add(n / 2, n - n / 2);
        const std::int64_t found = adam_on_device(launcher, blocks, 100.f);
        std::vector<float> after;
        value.to(after);
        CHECK(after == std::vector<float>(std::size_t(n), want_value));
        return found;
      };
      CHECK(first(-1.f) == kNoIndex);
      std::fill(grad.begin() + bad, grad.end(), 101.f);
      CHECK(first(0.f) == bad);
    }
  CHECK(adam_on_device(launcher, AdamBlocks(), 1.f) == kNoIndex);
}

}  // namespace ngs
