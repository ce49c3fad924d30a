#include "ngs/ops/device/tiles_kernel.h"

#include <doctest/doctest.h>

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

}  // namespace ngs
