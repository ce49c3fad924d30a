#include <doctest/doctest.h>

#include <cmath>

#include "ngs/edit/finish/support_view.h"

namespace ngs::finish {
namespace {

using orbit::Vec;

/// The unit ball's surface, all seen, and one Gaussian more that is not.
struct BallCase {
  GaussianCloud cloud;
  std::vector<std::uint8_t> seen;

  explicit BallCase(Vec hidden) {
    for (const Vec at : orbit::even_directions(3000)) add(at, true);
    add(hidden, false);
  }
  void add(Vec at, bool is_seen) {
    const auto i = std::size_t(cloud.size());
    cloud.resize(cloud.size() + 1, 0);
    const double p[3] = {at.x, at.y, at.z};
    for (std::size_t a = 0; a < 3; ++a) cloud.position[3 * i + a] = float(p[a]), cloud.log_scale[3 * i + a] = -3.2f;
    cloud.rotation[4 * i] = 1, cloud.logit_opacity[i] = 5, cloud.usable[i] = 1;
    seen.push_back(is_seen);
  }
  SeenHull hull() const { return SeenHull({}, cloud, seen, {{0, 0, 0}, 1}); }
};

}  // namespace

TEST_CASE("a hidden Gaussian among seen ones is surplus; points outside of the seen ones are outside of their hull") {
  const BallCase c({0.9, 0, 0});
  const SeenHull hull = c.hull();
  CHECK(hull.is_surplus(3000));
  CHECK(hull.is_hidden(3000));
  CHECK(!hull.is_surplus(0));
  CHECK(!hull.is_hidden(0));
  CHECK(hull.contains({0, 0, 0}));
  CHECK(hull.contains({0.95, 0, 0}));
  CHECK(!hull.contains({1.2, 0, 0}));
  CHECK(!hull.contains({0, -1.2, 0}));
  CHECK(hull.contains({0, -3, 0}));  // beyond what is known
}

TEST_CASE("hidden Gaussians among hidden ones are no surplus: it may be the object's unseen side") {
  BallCase c({0, 0, -1});
  for (std::size_t i = 0; i < c.seen.size(); ++i) c.seen[i] = c.cloud.position[3 * i + 2] > -0.3f;
  const SeenHull hull = c.hull();
  CHECK(!hull.is_surplus(3000));
  CHECK(hull.is_hidden(3000));
}

TEST_CASE("without hidden Gaussians, with too few, or with undefined rows nothing is surplus and all is contained") {
  BallCase c({0.9, 0, 0});
  c.seen.back() = 1;
  CHECK(!c.hull().is_surplus(3000));
  CHECK(c.hull().contains({1.5, 0, 0}));
  BallCase few({0.9, 0, 0});
  few.cloud.resize(0, 0), few.seen.clear();
  few.add({0, 0, 0}, true), few.add({0, 0.1, 0}, false);
  CHECK(!few.hull().is_surplus(1));
  BallCase odd({0.9, 0, 0});
  odd.cloud.position[3 * 3000] = NAN;
  classify(odd.cloud);
  CHECK(!odd.hull().is_surplus(3000));
}

}  // namespace ngs::finish
