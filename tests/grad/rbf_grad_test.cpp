// Mutants this kills: w_0 instead of w_j, row i instead of edge / K.
#include <doctest/doctest.h>

#include <vector>

#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/adjoint.h"
#include "support/random.h"

// A small random interpolation problem for the kernels, in any scalar type.

namespace ngs::test {

struct RbfShape {
  int queries, boundary, neighbours, features;
};

struct RbfCase {
  RbfShape shape;
  std::vector<double> query, boundary, feature;
  KnnGraph graph;

  RbfCase(RbfShape s, Random& random)
      : shape(s),
        query(random.uniform_vector(3 * std::size_t(s.queries), -1, 1)),
        boundary(random.uniform_vector(3 * std::size_t(s.boundary), -1, 1)),
        feature(random.uniform_vector(std::size_t(s.boundary * s.features), -1, 1)) {
    const std::vector<float> q(query.begin(), query.end()), x(boundary.begin(), boundary.end());
    graph = nearest_points({}, {x.data(), s.boundary}, {q.data(), s.queries}, s.neighbours);
  }
};

template <class T>
struct RbfOut {
  std::vector<T> weight, feature;
};

template <class T>
RbfOut<T> rbf_run(const RbfCase& c, const std::vector<T>& boundary, const std::vector<T>& feature, double inv_2h2) {
  const std::vector<T> q = constant<T>(c.query);
  const auto n = std::int64_t(c.shape.queries);
  RbfOut<T> r{std::vector<T>(c.graph.index.size()), std::vector<T>(std::size_t(n * c.shape.features))};
  const RbfForward<T> kernel{{q.data(), n},
                             {boundary.data(), c.shape.boundary},
                             c.graph.indices(),
                             {feature.data(), c.shape.boundary, c.shape.features},
                             T(inv_2h2),
                             {r.weight.data(), n, c.graph.neighbours},
                             {r.feature.data(), n, c.shape.features}};
  for (std::int64_t i = 0; i < n; ++i) kernel(i);
  return r;
}

}  // namespace ngs::test

namespace ngs {
namespace {

constexpr double kInv2h2 = 1.3;
constexpr test::RbfShape kShapes[] = {{1, 1, 1, 1}, {7, 5, 3, 4}, {64, 9, 8, 3}, {3, 2, 8, 1}};

std::vector<double> backward_feature(const test::RbfCase& c, const std::vector<double>& weight,
                                     const std::vector<double>& u) {
  std::vector<double> g(c.feature.size());
  const RbfBackwardFeature<double> kernel{c.graph.row_begin.data(),
                                          c.graph.edge.data(),
                                          {weight.data(), c.shape.queries, c.graph.neighbours},
                                          {u.data(), c.shape.queries, c.shape.features},
                                          {g.data(), c.shape.boundary, c.shape.features}};
  for (int j = 0; j < c.shape.boundary; ++j) kernel(j);
  return g;
}

}  // namespace

TEST_CASE("rbf: backward equals the adjoint of forward for features") {
  test::Random random(7);
  for (const test::RbfShape shape : kShapes) {
    CAPTURE(shape.queries);
    const test::RbfCase c(shape, random);
    const auto v = random.uniform_vector(c.feature.size(), -1, 1);
    const auto u = random.uniform_vector(std::size_t(shape.queries * shape.features), -1, 1);
    const auto dual = test::rbf_run(c, test::constant<test::DualD>(c.boundary), test::seed(c.feature, v), kInv2h2);
    const double u_jv = test::dot(u, test::deriv(dual.feature));
    const double jtu_v = test::dot(backward_feature(c, test::value(dual.weight), u), v);
    CHECK(test::adjoint_difference(u_jv, jtu_v) < 1e-12);
  }
}

}  // namespace ngs
