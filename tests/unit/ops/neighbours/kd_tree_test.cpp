#include "ngs/ops/neighbours/kd_tree.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/ops/neighbours/knn.h"
#include "support/random.h"

namespace ngs {
namespace {

/// The nearest points, in order; ties by index.
struct Nearest {
  std::size_t wanted;
  std::vector<std::pair<double, std::size_t>> best;

  double worst() const { return best.size() < wanted ? INFINITY : std::nextafter(best.back().first, INFINITY); }
  void add(double dist2, std::size_t index) {
    const std::pair candidate{dist2, index};
    best.insert(std::upper_bound(best.begin(), best.end(), candidate), candidate);
    if (best.size() > wanted) best.pop_back();
  }
};

}  // namespace

TEST_CASE("the tree of a browser finds the neighbours of an exact search, and of FLANN's, many at the same distance") {
  test::Random random(3);
  for (const int points : {1, 10, 11, 700, 3000}) {
    std::vector<float> at;
    for (int i = 0; i < 3 * points; ++i) at.push_back(float(std::round(random.uniform(-9, 9)) / 4));
    const std::vector<double> point(at.begin(), at.end());
    const KdTree tree(point);
    const int wanted = std::min(points, 8);
    const Rows<const float, 3> rows{at.data(), points};
    const KnnGraph by_flann = nearest_points({}, rows, rows, wanted);
    for (std::size_t query = 0; query < std::size_t(std::min(points, 300)); ++query) {
      Nearest by_tree{std::size_t(wanted), {}}, exact{std::size_t(wanted), {}};
      tree.search(by_tree, &point[3 * query]);
      for (std::size_t i = 0; i < std::size_t(points); ++i) {
        double dist2 = 0;
        for (std::size_t a = 0; a < 3; ++a) dist2 += std::pow(point[3 * query + a] - point[3 * i + a], 2);
        if (dist2 < exact.worst()) exact.add(dist2, i);
      }
      CHECK(by_tree.best == exact.best);
      for (std::size_t slot = 0; slot < by_tree.best.size(); ++slot)
        CHECK(by_tree.best[slot].second == by_flann.index[query * std::size_t(wanted) + slot]);
    }
  }
}

}  // namespace ngs
