#include "ngs/ops/field/rbf.h"

#include <algorithm>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/field/rbf_kernels.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/resident.h"

namespace ngs {
float inv_2h2(double width) {
  NGS_CHECK(width > 0, "the RBF width must be positive");
  return float(std::min(1.0 / (2.0 * width * width), double(std::numeric_limits<float>::max())));
}

void rbf_forward(const Exec& exec, const RbfProblem& problem, RbfField& out) {
  const KnnGraph& graph = *problem.graph;
  const int features = problem.feature.c;
  out.feature.resize(std::size_t(problem.query.n) * std::size_t(features));
  out.weight.resize(graph.index.size());
  if (graph.neighbours == 0) return fill_zero(exec, out.feature);
  NGS_CHECK(graph.queries() == problem.query.n && graph.points == problem.boundary.n,
            "the neighbour graph belongs to other points");
  if (exec.device_ops) return exec.device_ops->field.rbf_forward(problem, inv_2h2(problem.width), out);
  for_each_index(exec, problem.query.n,
                 RbfForward<float>{problem.query,
                                   problem.boundary,
                                   graph.indices(),
                                   problem.feature,
                                   inv_2h2(problem.width),
                                   {out.weight.data(), problem.query.n, graph.neighbours},
                                   {out.feature.data(), problem.query.n, features}});
}

void rbf_backward(const Exec& exec, const RbfProblem& problem, const RbfField& field, Matrix<const float> grad_feature,
                  std::vector<float>& out) {
  const KnnGraph& graph = *problem.graph;
  const std::int64_t points = problem.boundary.n;
  const int features = problem.feature.c;
  out.resize(std::size_t(points) * std::size_t(features));
  if (graph.neighbours == 0) return fill_zero(exec, out);
  if (exec.device_ops) return exec.device_ops->field.rbf_backward(problem, field, grad_feature, out);
  for_each_index(exec, points,
                 RbfBackwardFeature<float>{graph.row_begin.data(),
                                           graph.edge.data(),
                                           {field.weight.data(), graph.queries(), graph.neighbours},
                                           grad_feature,
                                           {out.data(), points, features}});
}

double auto_rbf_width(const Exec& exec, Rows<const float, 3> boundary, int neighbours, double factor) {
  const double spacing = mean_spacing(nearest_others(exec, boundary, neighbours));
  return spacing > 0 ? factor * spacing : 1.0;
}

}  // namespace ngs
