#pragma once
// A small random interpolation problem for the kernels, in any scalar type.
#include <vector>

#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/neighbours/knn.h"
#include "support/adjoint.h"
#include "support/random.h"

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
