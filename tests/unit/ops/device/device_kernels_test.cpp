#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>

#include "ngs/ops/device/adam_kernel.h"
#include "ngs/ops/device/splat_forward_kernel.h"
#include "ngs/ops/device/sum_kernel.h"
#include "ngs/ops/device/tiles_kernel.h"
#include "support/host_launcher.h"
#include "support/random.h"
#include "support/splat_case.h"

namespace ngs {

// The emulation runs one block after the other, so it cannot detect tiles that share rows.
TEST_CASE("splat forward kernel: tiles store their checkpoints in disjoint rows within the allocation") {
  test::Random random(3);
  for (int draw = 0; draw < 200; ++draw) {
    std::int64_t begin = 0, free_row = 0;
    const std::int64_t tiles = 1 + random.below(20);
    for (std::int64_t tile = 0; tile < tiles; ++tile) {
      const std::int64_t entries = random.below(2) == 0 ? random.below(3) : random.below(4 * Checkpoints::kEntries);
      const std::int64_t first = Checkpoints::first_row(begin, tile);
      if (entries > 0) {
        CHECK(first >= free_row);
        free_row = first + ceil_div<std::int64_t>(entries, Checkpoints::kEntries);
      }
      begin += entries;
    }
    CHECK(free_row <= Checkpoints::rows(begin, tiles));
  }
}

TEST_CASE("TileBins throws for more than 2^32 tile entries before it allocates memory for them") {
  test::SplatCase c = test::splat_case(5, 1100, 32000, 32000);
  const Vec3<double> ahead = c.camera.centre() + transpose(c.camera.rotation) * Vec3<double>{0, 0, 2};
  for (std::size_t i = 0; i < std::size_t(c.gaussians); ++i) {
    c.position[3 * i] = ahead.x;
    c.position[3 * i + 1] = ahead.y;
    c.position[3 * i + 2] = ahead.z;
    for (std::size_t k = 0; k < 3; ++k) c.log_scale[3 * i + k] = 4;
    c.logit_opacity[i] = 3;
  }
  const auto entries_of = [&](std::int64_t gaussians) {  // each reaches all of the 2000 x 2000 tiles
    test::HostLauncher launcher;
    const test::SplatArrays<float> arrays(c);
    CloudView<float> cloud = arrays.cloud();
    cloud.size = gaussians;
    const TileBins<test::HostLauncher> bins(launcher, view_projector<float>(c.camera, {}), cloud);
    return bins.pairs();
  };
  CHECK(entries_of(1) == 2000 * 2000);
  std::string message;
  try {
    entries_of(1100);
  } catch (const std::logic_error& e) {
    message = e.what();
  }
  CHECK(message.find("slots are counted in 32 bits") != std::string::npos);
}

// Shared memory has 32 banks of a float each. Two values of one bank cost a warp two accesses.
TEST_CASE("tiles kernel: the pixels of a warp, and a row of two Gaussians of a chunk, lie in 32 banks") {
  const TileFrame frame{0, 0, kTilePx, kTilePx};
  std::set<int> pixels;
  for (int warp = 0; warp < kTilePixels / kWarpThreads; ++warp)
    for (int j = 0; j < 2; ++j) {
      std::set<int> banks;
      for (int t = 0; t < kWarpThreads; ++t) {
        const int place = TilePixel(warp * kWarpThreads + t, frame).place();
        banks.insert(chunk_place(j, place) % kWarpThreads);
        pixels.insert(place);
      }
      CHECK(banks.size() == std::size_t(kWarpThreads));
    }
  CHECK(pixels.size() == std::size_t(kTilePixels));
  for (int row = 0; row < kTilePx; ++row) {
    std::set<int> banks;
    for (int j = 0; j < 2; ++j)
      for (int x = 0; x < kTilePx; ++x) banks.insert(chunk_place(j, pixel_place(x, row)) % kWarpThreads);
    CHECK(banks.size() == std::size_t(kWarpThreads));
  }
}

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
      for (std::int64_t row = rows.first; row < rows.end; row += rows.step) {
        ++times[std::size_t(row)];
        ++count;
      }
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
        add(0, n / 2);
        add(n / 2, n - n / 2);
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
