#include "ngs/edit/select/clean_rules.h"

#include <doctest/doctest.h>

#include <limits>

#include "support/splat_shapes.h"

namespace ngs {
namespace {

Debris last_of(const GaussianCloud& cloud, const CleanOptions& options = {}) {
  return find_debris({}, options, cloud).debris.back();
}

GaussianCloud sphere() {
  GaussianCloud cloud;
  test::add_sphere(cloud, {0, 0, 0}, 1, 600);
  return cloud;
}

void stretch_last(GaussianCloud& cloud, double x, double y, double z) {
  const double s[3] = {x, y, z};
  for (std::size_t a = 0; a < 3; ++a) cloud.log_scale[cloud.log_scale.size() - 3 + a] = float(std::log(s[a]));
}

}  // namespace

TEST_CASE("a clean model and an empty model have no debris") {
  CHECK(find_debris({}, {}, sphere()).counts[0] == 600);
  CHECK(find_debris({}, {}, GaussianCloud{}).debris.empty());
}

TEST_CASE("a long Gaussian is a needle, a flat disc is not") {
  GaussianCloud cloud = sphere();
  test::add_gaussian(cloud, {0, 0, 1}, 0.05);
  stretch_last(cloud, 0.1, 0.1, 1e-6);  // largest over smallest would call it a needle
  CHECK(last_of(cloud) == Debris::kNone);
  stretch_last(cloud, 0.1, 5e-4, 1e-6);
  CHECK(last_of(cloud) == Debris::kNeedle);
  CHECK(last_of(cloud, {.max_needle = 0}) == Debris::kNone);
}

TEST_CASE("the size limit grows with the distance from the middle") {
  GaussianCloud cloud = sphere();
  test::add_gaussian(cloud, {0, 0, 0.5}, 2);
  CHECK(last_of(cloud) == Debris::kOversized);
  CHECK(last_of(cloud, {.max_size = 0}) == Debris::kNone);
  cloud.position.back() = 20;  // in the sky
  CHECK(last_of(cloud, {.isolation = 0}) == Debris::kNone);
}

TEST_CASE("near-transparent and unusable Gaussians are debris, unless the thresholds are 0") {
  GaussianCloud cloud = sphere();
  test::add_gaussian(cloud, {0, 0, 1}, 0.05);
  cloud.logit_opacity.back() = -5.4f;  // 0.0045
  CHECK(last_of(cloud) == Debris::kTransparent);
  CHECK(last_of(cloud, {.min_opacity = 0}) == Debris::kNone);
  cloud.position.back() = std::numeric_limits<float>::quiet_NaN();
  cloud.usable.back() = 0;
  CHECK(last_of(cloud) == Debris::kUnusable);
}

TEST_CASE("isolation is relative to the local spacing: a sparse background is not isolated") {
  GaussianCloud cloud = sphere();
  const std::size_t dense = std::size_t(cloud.size());
  test::add_floor(cloud, 20, -5, 2);  // twenty times as sparse: no single length would separate both cases
  test::add_gaussian(cloud, {0, 0, 4.8}, 0.02);
  const CleanFinding found = find_debris({}, {.floater_size = 0}, cloud);
  CHECK(found.debris.back() == Debris::kIsolated);
  CHECK(found.counts[std::size_t(Debris::kIsolated)] == 1);
  CHECK(found.debris[dense] == Debris::kNone);
}

TEST_CASE("a clump in the air is a floater, even if an oversized Gaussian connected it to the object") {
  GaussianCloud cloud = sphere();
  test::add_sphere(cloud, {0, 0, 4}, 0.1, 60);
  CleanFinding found = find_debris({}, {}, cloud);
  CHECK(found.counts[std::size_t(Debris::kFloater)] == 60);
  CHECK(found.debris[0] == Debris::kNone);
  test::add_gaussian(cloud, {0, 0, 2}, 3);  // oversized, and reaches both
  found = find_debris({}, {}, cloud);
  CHECK(found.debris.back() == Debris::kOversized);
  CHECK(found.counts[std::size_t(Debris::kFloater)] == 60);
  CHECK(find_debris({}, {.floater_size = 59}, cloud).counts[std::size_t(Debris::kFloater)] == 0);
}

TEST_CASE("a clump on the surface is not a floater, although all its nearest neighbours are its own") {
  GaussianCloud cloud = sphere();
  test::add_sphere(cloud, {0, 0, 1.05}, 0.004, 30);
  CHECK(find_debris({}, {}, cloud).counts[0] == 630);
}

TEST_CASE("a few Gaussians, and coincident ones, are not isolated") {
  GaussianCloud cloud;
  for (int n = 1; n <= 12; ++n) {
    test::add_gaussian(cloud, {1, 2, 3}, 0.1);
    CAPTURE(n);
    CHECK(find_debris({}, {.max_size = 0}, cloud).counts[0] == n);
  }
  CHECK(find_debris({}, {.max_size = 0, .isolation = 1e-3}, cloud).counts[0] == 12);
}

}  // namespace ngs
