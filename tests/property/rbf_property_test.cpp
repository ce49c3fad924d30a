#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "ngs/ops/field/rbf.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/random.h"

namespace ngs {
namespace {

struct Scene {
  std::vector<float> query, boundary, feature;
  KnnGraph graph;
  double width = 0.4;
  int features = 3;

  Scene(std::int64_t queries, std::int64_t points, std::uint64_t seed) {
    test::Random random(seed);
    query = random.uniform_vector<float>(std::size_t(queries) * 3, -1.5, 1.5);
    boundary = random.uniform_vector<float>(std::size_t(points) * 3, -1, 1);
    feature = random.uniform_vector<float>(std::size_t(points) * 3, 0, 1);
    link();
  }
  void link() { graph = nearest_points({}, {boundary.data(), points()}, {query.data(), queries()}, 8); }
  std::int64_t queries() const { return std::int64_t(query.size() / 3); }
  std::int64_t points() const { return std::int64_t(boundary.size() / 3); }
  RbfProblem problem() const {
    return {
        {query.data(), queries()}, {boundary.data(), points()}, {feature.data(), points(), features}, &graph, width};
  }
};

RbfField forward(const Scene& s, int threads = 1) {
  RbfField field;
  rbf_forward({.threads = threads}, s.problem(), field);
  return field;
}

}  // namespace

TEST_CASE("rbf weights sum to one and interpolated features lie between those of the neighbours") {
  const Scene s(500, 60, 1);
  const RbfField field = forward(s);
  for (std::size_t i = 0; i < 500; ++i) {
    const float* w = &field.weight[i * 8];
    CHECK(std::accumulate(w, w + 8, 0.0) == doctest::Approx(1).epsilon(1e-6));
    for (int c = 0; c < 3; ++c) {
      float lo = 1, hi = 0;
      for (std::size_t slot = 0; slot < 8; ++slot) {
        const float f = s.feature[s.graph.index[i * 8 + slot] * 3 + std::size_t(c)];
        lo = std::min(lo, f);
        hi = std::max(hi, f);
      }
      CHECK(field.feature[i * 3 + std::size_t(c)] >= lo - 1e-6f);
      CHECK(field.feature[i * 3 + std::size_t(c)] <= hi + 1e-6f);
    }
  }
}

TEST_CASE("rbf does not depend on the order of the boundary Gaussians") {
  Scene s(300, 50, 2);
  const RbfField want = forward(s);
  Scene p = s;
  std::vector<std::size_t> order(50);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::reverse(order.begin() + 7, order.end());
  for (std::size_t j = 0; j < 50; ++j)
    for (std::size_t c = 0; c < 3; ++c) {
      p.boundary[j * 3 + c] = s.boundary[order[j] * 3 + c];
      p.feature[j * 3 + c] = s.feature[order[j] * 3 + c];
    }
  p.link();
  CHECK(forward(p).feature == want.feature);  // no ties in random data: the same neighbours in the same order
}

TEST_CASE("rbf gives the same bytes for 1 and 7 threads, forward and backward") {
  const Scene s(3000, 200, 3);
  const RbfField one = forward(s, 1), seven = forward(s, 7);
  CHECK(one.feature == seven.feature);
  CHECK(one.weight == seven.weight);
  test::Random random(4);
  const auto grad = random.uniform_vector<float>(9000, -1, 1);
  std::vector<float> grad_one, grad_seven;
  rbf_backward({}, s.problem(), one, {grad.data(), 3000, 3}, grad_one);
  rbf_backward({.threads = 7}, s.problem(), one, {grad.data(), 3000, 3}, grad_seven);
  CHECK(grad_one == grad_seven);
}

TEST_CASE("rbf with no boundary Gaussians gives zero features and no gradients") {
  Scene s(5, 0, 5);
  const RbfField field = forward(s);
  CHECK(field.feature == std::vector<float>(15, 0.f));
  std::vector<float> gradient(3);
  rbf_backward({}, s.problem(), field, {field.feature.data(), 5, 3}, gradient);
  CHECK(gradient.empty());
}

TEST_CASE("rbf with one boundary Gaussian reproduces its feature exactly at any distance") {
  Scene s(20, 1, 6);
  s.query[0] = 1e6f;
  s.link();
  const RbfField field = forward(s);
  for (std::size_t i = 0; i < 20; ++i)
    for (std::size_t c = 0; c < 3; ++c) CHECK(field.feature[i * 3 + c] == s.feature[c]);
}

TEST_CASE("the automatic rbf width is proportional to the scene's scale and defined for coincident Gaussians") {
  Scene s(1, 100, 7);
  const double width = auto_rbf_width({}, {s.boundary.data(), 100}, 8, 1.0);
  for (float& x : s.boundary) x *= 4;  // exact in float
  CHECK(auto_rbf_width({}, {s.boundary.data(), 100}, 8, 0.5) == doctest::Approx(2 * width).epsilon(1e-6));
  const std::vector<float> same(30, 2.5f);
  CHECK(auto_rbf_width({}, {same.data(), 10}, 8, 1.0) == 1.0);
  CHECK(auto_rbf_width({}, {same.data(), 1}, 8, 1.0) == 1.0);
}

}  // namespace ngs
