#include "ngs/edit/select/clean_rules.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "ngs/edit/select/needles.h"
#include "ngs/edit/select/touched_pieces.h"
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

namespace {

/// Two lattices of 8 x 8 x 8 compact Gaussians, 0.1 apart: the object above z = 0, the background below; and one
/// Gaussian of the object at its lower side, `length` long along `axis`.
struct Statue {
  GaussianCloud cloud;
  std::vector<std::uint8_t> object;

  Statue(int axis, double length, bool has_background = true) {
    for (const bool below : has_background ? std::vector<bool>{false, true} : std::vector<bool>{false})
      for (int k = 0; k < 512; ++k) {
        const double z = 0.05 + 0.1 * (k / 64);
        test::add_gaussian(cloud, {0.1 * (k % 8), 0.1 * (k / 8 % 8), below ? -z : z}, 0.02);
        object.push_back(!below);
      }
    Vec3<double> deviation{0.02, 0.02, 0.02};
    (&deviation.x)[axis] = length;
    test::add_gaussian(cloud, {0.35, 0.35, 0.05}, deviation);
    object.push_back(1);
    classify(cloud);
  }
  std::uint32_t last() const { return std::uint32_t(object.size() - 1); }
};

using RowList = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("a long Gaussian that reaches into the background is a needle, one along the cut or inside is none") {
  const Statue down(2, 0.3);
  CHECK(needles_beyond({}, down.cloud, down.object, 0.2) == RowList{down.last()});
  const Statue along(0, 0.15);
  CHECK(needles_beyond({}, along.cloud, along.object, 0.2).empty());
  const Statue compact(2, 0.02);
  CHECK(needles_beyond({}, compact.cloud, compact.object, 0.2).empty());
  CHECK(needles_beyond({}, down.cloud, down.object, 0).empty());
}

TEST_CASE("a long Gaussian that ends in empty space, as a whisker, is no needle") {
  const Statue whisker(2, 0.3, false);
  CHECK(needles_beyond({}, whisker.cloud, whisker.object, 0.2).empty());
  const Statue sideways(0, 0.6);  // beyond both blocks
  CHECK(needles_beyond({}, sideways.cloud, sideways.object, 0.2).empty());
}

TEST_CASE("a long Gaussian among sparse ones of the object is no needle, although it ends far from all of them") {
  Statue statue(2, 0.3);
  for (int k = 0; k < 40; ++k) {  // 0.4 apart, below the block, in the background
    test::add_gaussian(statue.cloud, {0.4 * (k % 4) - 0.25, 0.4 * (k / 4 % 5) - 0.45, -0.3 - 0.4 * (k / 20)}, 0.1);
    statue.object.push_back(1);
  }
  classify(statue.cloud);
  CHECK(needles_beyond({}, statue.cloud, statue.object, 0.2).empty());
}

TEST_CASE("needles are the same for any number of threads, and touched pieces do not have them") {
  const Statue statue(2, 0.3);
  CHECK(needles_beyond({.threads = 1}, statue.cloud, statue.object, 0.2) ==
        needles_beyond({.threads = 3}, statue.cloud, statue.object, 0.2));
  ViewSums stroke{0, false, {}, {}};
  const double weight = 1;
  for (std::uint32_t i = 0; i < 20; ++i) stroke.add(i, &weight);
  const PieceSelection pieces = touched_pieces({}, statue.cloud, statue.object, std::vector{stroke});
  CHECK(pieces.needles == 1);
  CHECK(pieces.removed == 0);
  CHECK(pieces.object[statue.last()] == 0);
  CHECK(pieces.object[0] == 1);
}

}  // namespace ngs
