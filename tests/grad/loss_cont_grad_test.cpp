#include <doctest/doctest.h>

#include "ngs/ops/losses/loss_cont_kernels.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/adjoint.h"
#include "support/random.h"

namespace ngs {
namespace {

struct ContCase {
  KnnGraph graph;
  std::vector<double> colour, weight;

  ContCase(test::Random& random, std::int64_t n, bool weighted)
      : colour(random.uniform_vector(std::size_t(n) * 3, 0, 1)) {
    const auto points = random.uniform_vector<float>(std::size_t(n) * 3, -1, 1);
    graph = nearest_others({}, {points.data(), n}, 4);
    if (weighted) weight = random.uniform_vector(graph.index.size(), 0, 1);
  }
  std::int64_t size() const { return std::int64_t(colour.size() / 3); }
  template <class T>
  ContinuityGraph<T> view(const std::vector<T>& c, const std::vector<T>& w) const {
    return {
        graph.indices(), graph.row_begin.data(), graph.edge.data(), w.empty() ? nullptr : w.data(), {c.data(), size()}};
  }
  template <class T>
  T loss(const std::vector<T>& c) const {
    const auto w = test::constant<T>(weight);
    std::vector<T> term(std::size_t(size()), T(0));
    const ContinuityForward<T> kernel{view(c, w), term.data()};
    T sum(0);
    for (std::int64_t i = 0; i < size(); ++i) {
      kernel(i);
      sum += term[std::size_t(i)];
    }
    return T(1.9) * sum;
  }
  std::vector<double> gradient() const {
    std::vector<double> g(colour.size());
    const ContinuityBackward<double> kernel{view(colour, weight), 1.9, {g.data(), size()}};
    for (std::int64_t i = 0; i < size(); ++i) kernel(i);
    return g;
  }
};

}  // namespace

TEST_CASE("loss_cont: backward gathers both directions of every edge and equals the adjoint of forward") {
  test::Random random(71);
  for (const std::int64_t n : {2, 3, 5, 60})
    for (const bool weighted : {false, true}) {
      const ContCase c(random, n, weighted);
      const auto v = random.uniform_vector(c.colour.size(), -1, 1);
      CHECK(test::adjoint_difference(c.loss(test::seed(c.colour, v)).d, test::dot(c.gradient(), v)) < 1e-12);
    }
}

TEST_CASE("loss_cont: the gradient agrees with extrapolated finite differences") {
  test::Random random(72);
  const ContCase c(random, 20, true);
  const auto v = random.uniform_vector(c.colour.size(), -1, 1);
  const auto along = [&](double t) { return c.loss(test::moved(c.colour, v, t)); };
  CHECK(test::ridders_difference(test::ridders(along, 0.1), test::dot(c.gradient(), v)) < 1e-10);
}

}  // namespace ngs
