#include "ngs/ops/neighbours/knn.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/ops/neighbours/kd_tree.h"
#include "support/random.h"

namespace ngs {
namespace {

Rows<const float, 3> rows(const std::vector<float>& v) { return {v.data(), std::int64_t(v.size() / 3)}; }

double dist2(const float* a, const float* b) {
  double s = 0;
  for (int c = 0; c < 3; ++c) s += (double(a[c]) - b[c]) * (double(a[c]) - b[c]);
  return s;
}

/// Reference for nearest_points: sorts all points.
KnnGraph brute_force(const std::vector<float>& points, const std::vector<float>& queries, int k, bool exclude_self) {
  KnnGraph graph;
  const std::size_t n = points.size() / 3;
  graph.neighbours = int(std::min<std::size_t>(std::size_t(k), n - (exclude_self ? 1 : 0)));
  for (std::size_t i = 0; i < queries.size() / 3; ++i) {
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::size_t j = 0; j < n; ++j)
      if (!exclude_self || i != j) all.emplace_back(dist2(&queries[3 * i], &points[3 * j]), std::uint32_t(j));
    std::sort(all.begin(), all.end());
    for (int slot = 0; slot < graph.neighbours; ++slot) {
      graph.index.push_back(all[std::size_t(slot)].second);
      graph.dist2.push_back(float(all[std::size_t(slot)].first));
    }
  }
  return graph;
}

void check_equal(const KnnGraph& got, const KnnGraph& want) {
  CHECK(got.neighbours == want.neighbours);
  CHECK(got.index == want.index);
  CHECK(got.dist2 == want.dist2);
}

}  // namespace

TEST_CASE("knn gives empty tables without points or without queries") {
  const std::vector<float> none, one{1, 2, 3};
  CHECK(nearest_points({}, rows(none), rows(one), 8).neighbours == 0);
  CHECK(nearest_points({}, rows(one), rows(none), 8).index.empty());
  const KnnGraph self = nearest_others({}, rows(one), 8);
  CHECK(self.neighbours == 0);
  CHECK(self.row_begin == std::vector<std::int64_t>{0, 0});
}

TEST_CASE("any_within equals a comparison of the nearest distance with the radius, ties included") {
  test::Random random(3);
  std::vector<float> points, queries;
  for (int i = 0; i < 3 * 500; ++i)
    points.push_back(float(std::round(random.uniform(-8, 8)) / 4));  // many equal distances
  for (int i = 0; i < 3 * 300; ++i) queries.push_back(float(std::round(random.uniform(-16, 16)) / 4));
  const KnnGraph nearest = nearest_points({}, rows(points), rows(queries), 1);
  for (const double radius : {0.0, 0.25, 0.5, 1.0, 3.0, 100.0}) {
    const std::vector<std::uint8_t> near = any_within({}, rows(points), rows(queries), radius);
    std::size_t ties = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      CHECK(near[i] == (double(nearest.dist2[i]) <= radius * radius));
      ties += double(nearest.dist2[i]) == radius * radius;
    }
    if (radius < 1) CHECK(ties > 0);
  }
  const std::vector<float> origin{0, 0, 0}, query_at_radius{1, 0, 0};  // same distance to the only point and to its box
  CHECK(any_within({}, rows(origin), rows(query_at_radius), 1) == std::vector<std::uint8_t>{1});
  queries[0] = NAN;
  std::vector<std::uint8_t> active(300, 1), expected = any_within({}, rows(points), {queries.data() + 3, 299}, 1);
  expected.insert(expected.begin(), 0);
  expected[7] = 0;
  active[0] = active[7] = 0;
  CHECK(any_within({}, rows(points), rows(queries), 1, active) == expected);
  CHECK_THROWS(any_within({}, rows(points), rows(queries), 1));
  queries[0] = 0;
  CHECK(any_within({}, rows({}), rows(queries), 1) == std::vector<std::uint8_t>(300, 0));
  CHECK(any_within({}, rows(points), rows({}), 1).empty());
}

TEST_CASE("knn equals a full sort for every small number of points, also on a lattice and of coincident points") {
  constexpr int kNeighbours = 4;
  test::Random random(1);
  for (const std::size_t n :
       {1u, 2u, unsigned(kNeighbours) - 1, unsigned(kNeighbours), unsigned(kNeighbours) + 1, 40u}) {
    const auto somewhere = random.uniform_vector<float>(3 * n, -1, 1),
               queries = random.uniform_vector<float>(27, -2, 2);
    for (const float cells : {0.f, 1.f, 1000.f}) {  // 0: all points are one, 1: most distances are equal
      CAPTURE(n);
      CAPTURE(cells);
      const auto snapped = [&](std::vector<float> at) {
        for (float& x : at) x = std::round(x * cells) / std::max(cells, 1.f);
        return at;
      };
      const auto points = snapped(somewhere), asked = snapped(queries);
      check_equal(nearest_points({}, rows(points), rows(asked), kNeighbours),
                  brute_force(points, asked, kNeighbours, false));
      if (n > 1)
        check_equal(nearest_others({}, rows(points), kNeighbours), brute_force(points, points, kNeighbours, true));
    }
  }
}

TEST_CASE("knn gives the same tables for any number of threads") {
  test::Random random(3);
  const auto points = random.uniform_vector<float>(3 * 700, -1, 1),
             queries = random.uniform_vector<float>(3 * 2000, -1, 1);
  const KnnGraph a = nearest_points({}, rows(points), rows(queries), 8),
                 b = nearest_points({.threads = 7}, rows(points), rows(queries), 8);
  check_equal(a, b);
  CHECK(a.edge == b.edge);
}

TEST_CASE("the transpose of a graph lists every edge once, ascending, under its point") {
  test::Random random(4);
  const auto points = random.uniform_vector<float>(3 * 30, -1, 1),
             queries = random.uniform_vector<float>(3 * 100, -1, 1);
  const KnnGraph graph = nearest_points({}, rows(points), rows(queries), 5);
  REQUIRE(graph.row_begin.size() == 31);
  CHECK(graph.row_begin.back() == 500);
  for (std::size_t j = 0; j < 30; ++j)
    for (std::int64_t e = graph.row_begin[j]; e < graph.row_begin[j + 1]; ++e) {
      CHECK(graph.index[std::size_t(graph.edge[std::size_t(e)])] == j);
      if (e > graph.row_begin[j]) CHECK(graph.edge[std::size_t(e)] > graph.edge[std::size_t(e - 1)]);
    }
}

TEST_CASE("knn throws for coordinates that are not finite") {
  const std::vector<float> bad{0, NAN, 0}, good{0, 0, 0};
  CHECK_THROWS_AS(nearest_points({}, rows(bad), rows(good), 1), std::logic_error);
  CHECK_THROWS_AS(nearest_points({}, rows(good), rows(bad), 1), std::logic_error);
}

TEST_CASE("the mean spacing of a regular row is its step") {
  const std::vector<float> points{0, 0, 0, 0.5f, 0, 0, 1, 0, 0, 1.5f, 0, 0};
  CHECK(mean_spacing(nearest_others({}, rows(points), 1)) == doctest::Approx(0.5).epsilon(1e-12));
  CHECK(mean_spacing(KnnGraph{}) == 0);
}

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
