#include "ngs/ops/device/tiles_kernel.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "support/host_launcher.h"
#include "support/splat_case.h"

namespace ngs {

TEST_CASE("TileBins throws for more than 2^32 tile entries before it allocates memory for them") {
  test::SplatCase c = test::splat_case(5, 1100, 32000, 32000);
  const Vec3<double> ahead = c.camera.centre() + transpose(c.camera.rotation) * Vec3<double>{0, 0, 2};
  for (std::size_t i = 0; i < std::size_t(c.gaussians); ++i) {
    c.position[3 * i] = ahead.x, c.position[3 * i + 1] = ahead.y, c.position[3 * i + 2] = ahead.z;
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
        banks.insert(chunk_place(j, place) % kWarpThreads), pixels.insert(place);
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

}  // namespace ngs
