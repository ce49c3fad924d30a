// Generated cameras follow the model: rotating, scaling and moving the model transforms them alike.
#include <doctest/doctest.h>

#include "ngs/orbit/orbit_stage.h"
#include "support/splat_shapes.h"

namespace ngs::orbit {

TEST_CASE("orbit cameras rotate about the up axis, scale and move with the model") {
  GaussianCloud cloud;
  test::add_box(cloud, {-0.8, -0.4, 0}, {0.8, 0.4, 0.5}, 0.08);
  test::add_sphere(cloud, {0.6, 0.1, 0.8}, 0.35, 300);
  OrbitOptions options;
  options.up = UpAxis::kZ;
  Monitor monitor;
  Exec exec;
  exec.threads = 2;
  const PictureSize size{160, 120};
  const OrbitCameras plain = choose_cameras(exec, monitor, cloud, options, size);
  test::Random random(11);
  for (int trial = 0; trial < 4; ++trial) {
    const double angle = random.uniform(0, 6.28), scale = std::exp(random.uniform(-1, 3));
    CAPTURE(trial);
    const double c = std::cos(angle), s = std::sin(angle);
    const Mat3<double> turn{{c, -s, 0, s, c, 0, 0, 0, 1}};
    const Vec shift{random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
    const OrbitCameras moved =
        choose_cameras(exec, monitor, test::transformed(cloud, turn, scale, shift), options, size);
    CHECK(moved.coverage == doctest::Approx(plain.coverage).epsilon(0.02));
    CHECK(moved.radius == doctest::Approx(scale * plain.radius).epsilon(1e-4));
    REQUIRE(moved.cameras.size() >= 24);
    for (std::size_t i = 0; i < 24; ++i) {
      const Vec expected = scale * (turn * plain.cameras[i].centre()) + shift;
      CHECK(length(moved.cameras[i].centre() - expected) < 1e-3 * scale * plain.radius);
      CHECK(moved.cameras[i].fx == doctest::Approx(plain.cameras[i].fx));
    }
  }
}

}  // namespace ngs::orbit
