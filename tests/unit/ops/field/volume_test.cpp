#include "ngs/ops/field/volume.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/random.h"

namespace ngs {
namespace {

VolumeOutput run(int samples, const std::vector<float>& density, const std::vector<float>& rgb,
                 const std::vector<float>& spacing, Vec3<float> background, int threads = 1) {
  VolumeOutput out;
  Exec exec;
  exec.threads = threads;
  volume_forward(exec, {samples, density.data(), rgb.data(), spacing.data(), std::int64_t(spacing.size()), background},
                 out);
  return out;
}

}  // namespace

TEST_CASE("volume: a homogeneous medium follows the Beer-Lambert law") {
  const double sigma = 1.7, spacing = 0.3;
  const VolumeOutput o = run(8, std::vector<float>(8, 1.7f), std::vector<float>(24, 0.5f), {0.3f}, {1, 0, 0.5f});
  const double alpha = 1 - std::exp(-8 * sigma * spacing);
  CHECK(double(o.alpha[0]) == doctest::Approx(alpha).epsilon(1e-6));
  CHECK(double(o.optical_depth[0]) == doctest::Approx(8 * sigma * spacing).epsilon(1e-6));
  CHECK(double(o.colour[0]) == doctest::Approx(0.5 * alpha + 1 - alpha).epsilon(1e-6));
  CHECK(double(o.colour[1]) == doctest::Approx(0.5 * alpha).epsilon(1e-6));
  CHECK(double(o.colour[2]) == doctest::Approx(0.5).epsilon(1e-6));
}

TEST_CASE("volume: no rays give empty output, rays without samples the background") {
  CHECK(run(8, {}, {}, {}, {0, 0, 0}).colour.empty());
  const VolumeOutput o = run(0, {}, {}, {1}, {0.5f, 0.5f, 0.5f});
  CHECK(o.colour == std::vector<float>(3, 0.5f));
  CHECK(o.alpha[0] == 0);
  VolumeGradients g;
  volume_backward({}, {0, nullptr, nullptr, nullptr, 1, {}}, o, {{1, 1, 1}, {1}, {}}, g);
  CHECK(g.density.empty());
}

TEST_CASE("volume: weights sum to alpha and bytes do not depend on the thread count") {
  test::Random random(1);
  const auto density = random.uniform_vector<float>(8000, 0, 20), rgb = random.uniform_vector<float>(24000, 0, 1);
  const auto spacing = random.uniform_vector<float>(1000, 0.01, 0.2);
  const VolumeOutput a = run(8, density, rgb, spacing, {1, 1, 1}), b = run(8, density, rgb, spacing, {1, 1, 1}, 7);
  CHECK(a.colour == b.colour);
  for (std::size_t r = 0; r < 1000; ++r) {
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k) sum += double(a.weight[r * 8 + k]);
    CHECK(sum == doctest::Approx(double(a.alpha[r])).epsilon(1e-5));
  }
}

}  // namespace ngs
