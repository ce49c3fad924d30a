#include "ngs/edit/select/support_plane.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/core/rng.h"

namespace ngs {
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
      for (double y = -half; y <= reach; y += 0.025) add({x, y, height}, false), add({x, y, -height}, false);
    for (double z = 0.105; z < 1; z += 0.01) add({0, 0, z}, false);
    classify(cloud);
  }

  void add(orbit::Vec at, bool floor) {
    const auto i = std::size_t(cloud.size());
    cloud.resize(cloud.size() + 1, 0);
    const double scale[3] = {0.05, 0.05, 0.002};
    const double position[3] = {at.x, at.y, at.z};
    for (std::size_t a = 0; a < 3; ++a)
      cloud.position[3 * i + a] = float(position[a]), cloud.log_scale[3 * i + a] = float(std::log(scale[a]));
    cloud.rotation[4 * i] = 1, cloud.logit_opacity[i] = 4;
    is_floor.push_back(floor), object.push_back(std::max(std::abs(at.x), std::abs(at.y)) <= reach);
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
