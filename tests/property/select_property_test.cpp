#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "ngs/edit/select/clean_rules.h"
#include "ngs/edit/select/region.h"
#include "ngs/orbit/orbit_stage.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

/// A flat grid floor: neighbours are equidistant and many positions differ in one coordinate only.
GaussianCloud scene() {
  GaussianCloud cloud;
  test::add_floor(cloud, 3, 0, 0.05);
  test::add_sphere(cloud, {0, 0, 1}, 0.5, 900);
  test::add_sphere(cloud, {2, 0, 1}, 0.5, 900);
  for (int i = 0; i < 40; ++i) test::add_gaussian(cloud, {2.5 * std::sin(9.0 * i), 2.5 * std::cos(7.0 * i), 4}, 0.02);
  return cloud;
}

GaussianCloud reordered(const GaussianCloud& cloud, const std::vector<std::size_t>& from) {
  GaussianCloud out;
  out.resize(cloud.size(), 0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::copy_n(&cloud.position[3 * from[i]], 3, &out.position[3 * i]);
    std::copy_n(&cloud.log_scale[3 * from[i]], 3, &out.log_scale[3 * i]);
    std::copy_n(&cloud.rotation[4 * from[i]], 4, &out.rotation[4 * i]);
    out.logit_opacity[i] = cloud.logit_opacity[from[i]];
  }
  return out;
}

Exec with_threads(int threads) {
  const Exec exec{.threads = threads};
  return exec;
}

}  // namespace

TEST_CASE("selection and debris do not depend on the order of rows or the number of threads") {
  const GaussianCloud cloud = scene();
  std::vector<std::size_t> from(std::size_t(cloud.size()));
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = (i * 7919 + 13) % from.size();
  std::vector<std::size_t> sorted = from;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::size_t> rows(from.size());
  std::iota(rows.begin(), rows.end(), std::size_t(0));
  REQUIRE(sorted == rows);  // a permutation
  const GaussianCloud shuffled = reordered(cloud, from);
  const std::vector<std::uint8_t> all(from.size(), 1);

  const RegionOptions region{.drop_below_plane = "auto", .up = UpAxis::kZ, .largest = 1};
  const RegionSelection a = select_region(with_threads(1), region, cloud, all);
  const RegionSelection b = select_region(with_threads(3), region, shuffled, all);
  const CleanFinding c = find_debris(with_threads(1), {}, cloud), d = find_debris(with_threads(3), {}, shuffled);
  CHECK(a.plane.offset == b.plane.offset);
  CHECK(std::count(a.object.begin(), a.object.end(), 1) > 800);
  CHECK(c.counts[0] < cloud.size());
  bool same_object = true, same_debris = true;
  for (std::size_t i = 0; i < from.size(); ++i) {
    same_object &= a.object[from[i]] == b.object[i];
    same_debris &= c.debris[from[i]] == d.debris[i];
  }
  CHECK(same_object);
  CHECK(same_debris);
}

}  // namespace ngs

namespace ngs::orbit {

TEST_CASE("orbit cameras rotate about the up axis, scale and move with the model") {
  GaussianCloud cloud;
  test::add_box(cloud, {-0.8, -0.4, 0}, {0.8, 0.4, 0.5}, 0.08);
  test::add_sphere(cloud, {0.6, 0.1, 0.8}, 0.35, 300);
  OrbitOptions options{.up = UpAxis::kZ, .around = {}};
  Monitor monitor;
  const Exec exec{.threads = 2};
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
