#include "ngs/field/rbf_stage.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

// Queries per k-NN search. Bounds the memory of the neighbour tables; the result does not depend on it.
constexpr std::int64_t kQueriesAtOnce = std::int64_t(1) << 19;
constexpr double kFarWidths = 4;

void require_finite(const QueryField& field) {
  for (std::size_t i = 0; i < field.position.size(); ++i)
    if (!std::isfinite(field.position[i]))
      throw Error(ErrorCode::kBadInput,
                  "query " + std::to_string(i / 3) + ": its position is not finite, expected numbers",
                  "write the queries again: ngs-sample scene.json boundary.ply -o queries.ply");
}

}  // namespace

void require_same_origin(const QueryField& field, const std::array<double, 3>& origin) {
  if (field.origin == origin) return;
  throw Error(ErrorCode::kInconsistent,
              "the queries are relative to another origin than the model, expected queries of this model",
              "sample again: ngs-sample scene.json boundary.ply -o queries.ply");
}

double rbf_width(const Exec& exec, const RbfOptions& options, Rows<const float, 3> boundary) {
  if (options.width == "auto") return auto_rbf_width(exec, boundary, options.neighbours, options.width_factor);
  double width = 0;
  if (!parse_number(options.width, width) || !(width > 0) || !std::isfinite(width))
    throw Error(ErrorCode::kUsage, "--width: '" + options.width + "', expected auto or a positive length",
                "--width auto, or for example --width 0.35");
  return width;
}

RbfSummary interpolate_features(const Exec& exec, Monitor& monitor, const RbfOptions& options,
                                const BoundarySet& boundary, QueryField& field) {
  require_finite(field);
  require_same_origin(field, boundary.origin);
  auto timed = monitor.scope("interpolate");
  timed.items(field.size());
  const Rows<const float, 3> points = boundary.positions();
  RbfSummary summary;
  summary.width = rbf_width(exec, options, points);
  field.features = 3;
  field.neighbours = int(std::min<std::int64_t>(options.neighbours, points.n));
  field.feature.clear();
  field.neighbour.clear();
  field.weight.clear();
  double nearest_sum = 0;
  for (std::int64_t begin = 0; begin < field.size(); begin += kQueriesAtOnce) {
    const Rows<const float, 3> queries{field.position.data() + begin * 3,
                                       std::min(kQueriesAtOnce, field.size() - begin)};
    const KnnGraph graph = nearest_points(exec, points, queries, options.neighbours);
    RbfField part;
    rbf_forward(exec, {queries, points, {boundary.colour.data(), points.n, 3}, &graph, summary.width}, part);
    field.feature.insert(field.feature.end(), part.feature.begin(), part.feature.end());
    field.weight.insert(field.weight.end(), part.weight.begin(), part.weight.end());
    for (const std::uint32_t j : graph.index) field.neighbour.push_back(boundary.row[j]);
    for (std::int64_t i = 0; i < graph.queries(); ++i) {
      const double distance = std::sqrt(double(graph.dist2[std::size_t(i * graph.neighbours)]));
      nearest_sum += distance;
      if (distance > kFarWidths * summary.width) ++summary.far_queries;
    }
    monitor.progress(begin + queries.n, field.size());
  }
  if (field.size() > 0) summary.mean_nearest = nearest_sum / double(field.size());
  return summary;
}

}  // namespace ngs
