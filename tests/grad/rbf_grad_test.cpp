// Mutants this kills: w_0 instead of w_j, row i instead of edge / K.
#include <doctest/doctest.h>

#include "support/rbf_case.h"

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
