// Mutants this kills: w_0 instead of w_j, row i instead of edge / K, a missing mean in the softmax backward,
// a factor 2 in the position gradient,
// queries that move with the boundary instead of against it.
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

std::vector<double> backward_exponent(const test::RbfCase& c, const std::vector<double>& weight,
                                      const std::vector<double>& u) {
  std::vector<double> exponent(weight.size());
  const std::int64_t n = c.shape.queries;
  const RbfBackwardExponent<double> first{c.graph.indices(),
                                          {c.feature.data(), c.shape.boundary, c.shape.features},
                                          {weight.data(), n, c.graph.neighbours},
                                          {u.data(), n, c.shape.features},
                                          {exponent.data(), n, c.graph.neighbours}};
  for (std::int64_t i = 0; i < n; ++i) first(i);
  return exponent;
}

std::vector<double> backward_position(const test::RbfCase& c, const std::vector<double>& weight,
                                      const std::vector<double>& u) {
  const std::vector<double> exponent = backward_exponent(c, weight, u);
  std::vector<double> g(c.boundary.size());
  const std::int64_t n = c.shape.queries;
  const RbfBackwardPosition<double> second{c.graph.row_begin.data(),
                                           c.graph.edge.data(),
                                           {exponent.data(), n, c.graph.neighbours},
                                           {c.query.data(), n},
                                           {c.boundary.data(), c.shape.boundary},
                                           kInv2h2,
                                           {g.data(), c.shape.boundary}};
  for (int j = 0; j < c.shape.boundary; ++j) second(j);
  return g;
}

std::vector<double> backward_query(const test::RbfCase& c, const std::vector<double>& weight,
                                   const std::vector<double>& u) {
  const std::vector<double> exponent = backward_exponent(c, weight, u);
  std::vector<double> g(c.query.size());
  const std::int64_t n = c.shape.queries;
  const RbfBackwardQuery<double> kernel{c.graph.indices(),
                                        {exponent.data(), n, c.graph.neighbours},
                                        {c.query.data(), n},
                                        {c.boundary.data(), c.shape.boundary},
                                        kInv2h2,
                                        {g.data(), n}};
  for (std::int64_t i = 0; i < n; ++i) kernel(i);
  return g;
}

}  // namespace

TEST_CASE("rbf: backward with respect to features is the adjoint of forward") {
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

TEST_CASE("rbf: backward with respect to boundary positions is the adjoint of forward") {
  test::Random random(8);
  for (const test::RbfShape shape : kShapes) {
    CAPTURE(shape.queries);
    const test::RbfCase c(shape, random);
    const auto v = random.uniform_vector(c.boundary.size(), -1, 1);
    const auto u = random.uniform_vector(std::size_t(shape.queries * shape.features), -1, 1);
    const auto dual = test::rbf_run(c, test::seed(c.boundary, v), test::constant<test::DualD>(c.feature), kInv2h2);
    const double u_jv = test::dot(u, test::deriv(dual.feature));
    const double jtu_v = test::dot(backward_position(c, test::value(dual.weight), u), v);
    if (shape.boundary == 1)
      CHECK((u_jv == 0 && jtu_v == 0));  // one neighbour: weight 1 wherever it is
    else
      CHECK(test::adjoint_difference(u_jv, jtu_v) < 1e-12);
  }
}

TEST_CASE("rbf: the position gradient agrees with extrapolated finite differences") {
  test::Random random(9);
  const test::RbfCase c({12, 9, 5, 3}, random);
  const auto v = random.uniform_vector(c.boundary.size(), -1, 1);
  const auto u = random.uniform_vector(36, -1, 1);
  const auto along = [&](double t) {
    return test::dot(u, test::rbf_run(c, test::moved(c.boundary, v, t), c.feature, kInv2h2).feature);
  };
  const auto weight = test::rbf_run(c, c.boundary, c.feature, kInv2h2).weight;
  CHECK(test::ridders_difference(test::ridders(along, 0.1), test::dot(backward_position(c, weight, u), v)) < 1e-9);
}

TEST_CASE("rbf: the gradient of the queries agrees with extrapolated finite differences") {
  test::Random random(10);
  const test::RbfCase c({12, 9, 5, 3}, random);
  const auto v = random.uniform_vector(c.query.size(), -1, 1);
  const auto u = random.uniform_vector(36, -1, 1);
  const auto along = [&](double t) {
    test::RbfCase at = c;
    at.query = test::moved(c.query, v, t);
    return test::dot(u, test::rbf_run(at, c.boundary, c.feature, kInv2h2).feature);
  };
  const auto weight = test::rbf_run(c, c.boundary, c.feature, kInv2h2).weight;
  CHECK(test::ridders_difference(test::ridders(along, 0.1), test::dot(backward_query(c, weight, u), v)) < 1e-9);
}

}  // namespace ngs
