#include "ngs/edit/select/region.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/edit/select/canonical_points.h"
#include "ngs/edit/select/support_plane.h"
#include "ngs/math/vectors.h"
#include "support/error_code.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

std::vector<std::uint8_t> all_of(const GaussianCloud& cloud) {
  return std::vector<std::uint8_t>(std::size_t(cloud.size()), 1);
}

RegionSelection selected(const GaussianCloud& cloud, const RegionOptions& options) {
  return select_region({}, options, cloud, all_of(cloud));
}

std::int64_t count(const RegionSelection& found) { return std::count(found.object.begin(), found.object.end(), 1); }

ErrorCode refusal(const RegionOptions& options) {
  try {
    parse_region(options);
  } catch (const Error& e) {
    return e.code();
  }
  return ErrorCode(0);
}

/// Turns the last Gaussian into a disc whose normal is `axis`.
void flatten(GaussianCloud& cloud, std::size_t axis) { cloud.log_scale[cloud.log_scale.size() - 3 + axis] -= 4; }

/// A pedestal of 1 x 1 x 2, z upwards, whose four sides are eight times as large as its top, and a ball on it.
GaussianCloud statue(std::size_t& pedestal) {
  GaussianCloud cloud;
  for (double u = -0.475; u < 0.5; u += 0.05) {
    for (double h = -1.975; h < 0; h += 0.05)
      for (const double side : {-0.5, 0.5}) {
        test::add_gaussian(cloud, {side, u, h}, 0.03);
        flatten(cloud, 0);
        test::add_gaussian(cloud, {u, side, h}, 0.03);
        flatten(cloud, 1);
      }
    for (double v = -0.475; v < 0.5; v += 0.05) {
      test::add_gaussian(cloud, {u, v, 0}, 0.03);
      flatten(cloud, 2);
    }
  }
  pedestal = std::size_t(cloud.size());
  test::add_sphere(cloud, {0, 0, 0.45}, 0.4, 800);
  return cloud;
}

}  // namespace

TEST_CASE("the top of a pedestal is found although its sides are larger") {
  std::size_t pedestal = 0;
  const GaussianCloud cloud = statue(pedestal);
  const RegionSelection found = selected(cloud, {.drop_below_plane = "auto", .up = UpAxis::kZ});
  REQUIRE(found.plane.found);
  CHECK(found.plane.normal.z > 0.9999);
  CHECK(std::abs(found.plane.offset) < 0.005);
  CHECK(std::count(found.object.begin(), found.object.begin() + std::ptrdiff_t(pedestal), 1) == 0);
  CHECK(count(found) > 790);
}

TEST_CASE("a floor tilted against the up axis is found, and the object on it stays complete") {
  GaussianCloud cloud;
  test::add_floor(cloud, 2, 0, 0.1);
  test::add_sphere(cloud, {0, 0, 0.6}, 0.5, 700);
  const double c = std::cos(0.2), s = std::sin(0.2);
  const RegionSelection found = selected(test::transformed(cloud, {{1, 0, 0, 0, c, -s, 0, s, c}}, 3, {5, 6, 7}),
                                         {.drop_below_plane = "auto", .up = UpAxis::kZ});
  CHECK(found.plane.normal.y == doctest::Approx(-s).epsilon(0.01));
  CHECK(count(found) == 700);  // a level plane would cut through the floor
}

TEST_CASE("refined_by corrects the tilt of a plane that was found from part of its points") {
  std::size_t pedestal = 0;
  const GaussianCloud cloud = statue(pedestal);
  const SupportPlane tilted{true, unit(orbit::Vec{0.06, -0.04, 1}), 0.02, 0.05, 0.5};
  const SupportPlane righted = refined_by(cloud, canonical_points(cloud), tilted);
  REQUIRE(righted.found);
  CHECK(righted.normal.z > 0.9999);
  CHECK(std::abs(righted.offset) < 0.005);
  CHECK(righted.thickness < 0.02);
  CHECK_FALSE(refined_by(cloud, canonical_points(cloud), {}).found);
  CHECK(refined_by(cloud, {}, tilted).normal.z == tilted.normal.z);
}

TEST_CASE("an object's own side is no supporting plane, for any rotation of the object") {
  // an upright guitar: a flat body whose two faces are 0.12 apart, and a neck
  GaussianCloud cloud;
  for (double x = -0.35; x < 0.35; x += 0.02)
    for (double y = -0.45; y < 0.45; y += 0.02)
      if (x * x / 0.1225 + y * y / 0.2025 < 1)
        for (const double side : {-0.06, 0.06}) {
          test::add_gaussian(cloud, {x, y, side}, 0.03);
          flatten(cloud, 2);
        }
  for (double y = -1.2; y < -0.4; y += 0.02)
    for (const double side : {-0.04, 0.04}) {
      test::add_gaussian(cloud, {side, y, 0}, 0.03);
      flatten(cloud, 0);
      test::add_gaussian(cloud, {0, y, side}, 0.03);
      flatten(cloud, 2);
    }
  for (const UpAxis up : {UpAxis::kAuto, UpAxis::kMinusY, UpAxis::kZ, UpAxis::kMinusZ, UpAxis::kX}) {
    CAPTURE(int(up));
    test::refused([&] { selected(cloud, {.drop_below_plane = "auto", .up = up}); }, ErrorCode::kNothingFound,
                  "no supporting plane");
  }
}

TEST_CASE("a slice through a round body is no supporting plane") {
  GaussianCloud cloud;
  test::add_sphere(cloud, {0, 0, 0}, 0.5, 3000);
  test::add_sphere(cloud, {0, 0, 0.62}, 0.15, 600);
  for (const UpAxis up : {UpAxis::kAuto, UpAxis::kZ, UpAxis::kMinusZ})
    CHECK_THROWS_AS(selected(cloud, {.drop_below_plane = "auto", .up = up}), Error);
}

TEST_CASE("a model without a supporting plane gets none") {
  GaussianCloud cloud;
  for (int i = 0; i < 50; ++i) test::add_gaussian(cloud, {1, 2, 3}, 0.1);
  CHECK_THROWS_AS(selected(cloud, {.drop_below_plane = "auto"}), Error);
  CHECK(count(selected(GaussianCloud{}, {.drop_below_plane = "auto"})) == 0);
}

TEST_CASE("Gaussians with a negative value of a given plane are below it, for any length of its normal") {
  GaussianCloud cloud;
  for (const double z : {0.5, 1.5, 2.5}) test::add_gaussian(cloud, {0, 0, z}, 0.1);
  cloud.origin = {0, 0, 1};
  CHECK(selected(cloud, {.drop_below_plane = "0,0,10,-20"}).object == std::vector<std::uint8_t>{0, 1, 1});
}

TEST_CASE("boxes and balls are a union, their corners in any order, in world coordinates") {
  GaussianCloud cloud;
  for (int x = 0; x < 6; ++x) test::add_gaussian(cloud, {double(x), 0, 0}, 0.1);
  cloud.origin = {100, 0, 0};
  CHECK(selected(cloud, {.keep_box = {"101.5,1,1,99,-1,-1"}, .keep_sphere = {"105,0,0,0.5"}}).object ==
        std::vector<std::uint8_t>{1, 1, 0, 0, 0, 1});
}

TEST_CASE("clusters are joined by solid Gaussians, not by haze between them") {
  GaussianCloud cloud;
  test::add_sphere(cloud, {0, 0, 0}, 1, 400);
  test::add_sphere(cloud, {6, 0, 0}, 1, 300);
  for (double x = 1; x <= 5; x += 0.05) {
    test::add_gaussian(cloud, {x, 0, 0}, 0.05);
    cloud.logit_opacity.back() = -4;
  }
  const Clusters clusters = cluster_on_grid({}, cloud, all_of(cloud), 0.5);
  REQUIRE(clusters.size.size() == 2);
  CHECK(clusters.of_row[0] == 0);
  CHECK(clusters.of_row[400] == 1);
  CHECK(clusters.of_row[740] == -1);  // in the haze
  const RegionSelection second = selected(cloud, {.cluster_at = {"5,0,0"}, .cluster_side = 0.5});
  CHECK(second.object[0] == 0);
  CHECK(second.object[400] == 1);
  CHECK(count(selected(cloud, {.largest = 5, .cluster_side = 0.5})) == clusters.size[0] + clusters.size[1]);
}

TEST_CASE("a dense clump is in one cluster with the surface that it touches") {
  GaussianCloud cloud;  // links to the 8 nearest would not connect these twelve to the sphere they lie on
  test::add_sphere(cloud, {0, 0, 0}, 1, 400);
  for (int i = 0; i < 12; ++i) test::add_gaussian(cloud, {0, 0, 1.01 + 1e-5 * i}, 0.05);
  CHECK(cluster_on_grid({}, cloud, all_of(cloud)).size.size() == 1);
}

TEST_CASE("none, one and coincident Gaussians have clusters") {
  GaussianCloud cloud;
  CHECK(cluster_on_grid({}, cloud, {}).size.empty());
  test::add_gaussian(cloud, {3, 4, 5}, 0.1);
  CHECK(cluster_on_grid({}, cloud, {1}).size == std::vector<std::int64_t>{1});
  for (int i = 0; i < 3; ++i) test::add_gaussian(cloud, {3, 4, 5}, 0.1);
  CHECK(cluster_on_grid({}, cloud, all_of(cloud)).size == std::vector<std::int64_t>{4});
  cloud.usable[2] = 0;
  CHECK(count(selected(cloud, {.largest = 1})) == 3);
}

TEST_CASE("invalid regions are errors") {
  CHECK(refusal({.keep_box = {"0,0,0,1,1"}}) == ErrorCode::kUsage);
  CHECK(refusal({.keep_box = {"0,0,0,0,1,1"}}) == ErrorCode::kUsage);
  CHECK(refusal({.keep_sphere = {"0,0,0,0"}}) == ErrorCode::kUsage);
  CHECK(refusal({.keep_sphere = {"0,0,nan,1"}}) == ErrorCode::kUsage);
  CHECK(refusal({.drop_below_plane = "0,0,0,1"}) == ErrorCode::kUsage);
  CHECK(refusal({.drop_below_plane = "automatic"}) == ErrorCode::kUsage);
  CHECK(refusal({.cluster_at = {"1,2,3,"}}) == ErrorCode::kUsage);
  CHECK(refusal({.drop_below_plane = "auto", .cluster_at = {"1,-2,3e-1"}}) == ErrorCode(0));
}

namespace {

/// A floor of flat Gaussians at z = 0, of standard deviation `rough`, and a denser rug from -`half` to `half`, at
/// `height` above and below it, with a post.
struct Floor {
  GaussianCloud cloud;
  double reach;
  std::vector<std::uint8_t> is_floor, object;  // object: everything within the rug, the floor there included

  explicit Floor(double rough, double half = 0.5, double height = 0.02) : reach(half + 0.01) {
    std::uint64_t index = 0;
    for (double x = -2; x <= 2.01; x += 0.05)
      for (double y = -2; y <= 2.01; y += 0.05) add({x, y, rough * rng_normal(0, RngStream::kTest, index++)}, true);
    for (double x = -half; x <= reach; x += 0.025)
      for (double y = -half; y <= reach; y += 0.025) {
        add({x, y, height}, false);
        add({x, y, -height}, false);
      }
    for (double z = 0.105; z < 1; z += 0.01) add({0, 0, z}, false);
    classify(cloud);
  }

  void add(orbit::Vec at, bool floor) {
    test::add_gaussian(cloud, at, {0.05, 0.05, 0.002}, {}, 4);
    is_floor.push_back(floor);
    object.push_back(std::max(std::abs(at.x), std::abs(at.y)) <= reach);
  }

  std::int64_t count(bool floor) const {
    std::int64_t rows = 0;
    for (std::size_t i = 0; i < object.size(); ++i) rows += object[i] && (is_floor[i] != 0) == floor;
    return rows;
  }
};

constexpr std::int64_t kRug = 2 * 41 * 41, kPost = 90;
const orbit::Vec kUp{0, 0, 1};

}  // namespace

TEST_CASE("the floor between both sides of a rug is left out, and neither side is") {
  Floor exact(0);
  REQUIRE(exact.count(true) > 400);
  REQUIRE(exact.count(false) == kRug + kPost);
  remove_support(exact.cloud, kUp, exact.object);
  CHECK(exact.count(true) == 0);
  CHECK(exact.count(false) == kRug + kPost);
}

TEST_CASE("a rug that is flatter and larger than the rest of the floor is not taken for the floor") {
  Floor wide(0, 1.7, 0.2);
  const std::int64_t rug = wide.count(false);
  remove_support(wide.cloud, kUp, wide.object);
  CHECK(wide.count(true) == 0);
  CHECK(wide.count(false) == rug);
}

TEST_CASE("a floor that is rougher than the rug is thick takes the rug with it") {
  Floor rough(0.01);
  const std::int64_t under = rough.count(true);
  remove_support(rough.cloud, kUp, rough.object);
  CHECK(double(rough.count(true)) < 0.02 * double(under));
  CHECK(rough.count(false) == kPost);
}

TEST_CASE("without a plane outside of the object nothing is left out") {
  Floor floor(0);
  std::fill(floor.object.begin(), floor.object.end(), std::uint8_t(1));
  remove_support(floor.cloud, kUp, floor.object);
  CHECK(std::count(floor.object.begin(), floor.object.end(), 1) == floor.cloud.size());
  GaussianCloud none;
  std::vector<std::uint8_t> empty;
  remove_support(none, kUp, empty);
  CHECK(empty.empty());
}

}  // namespace ngs
