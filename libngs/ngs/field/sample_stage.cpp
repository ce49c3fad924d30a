#include "ngs/field/sample_stage.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs {
namespace {

RenderedView render_depth(const Exec& exec, const GaussianCloud& cloud, const Camera& camera,
                          const SplatOptions& splat) {
  RenderRequest request{.colour = false, .depth = true, .label = {}};
  return render(exec, cloud, camera, splat, request);
}

void append(const ViewSample& sample, const Camera& camera, QueryField& field) {
  const RayQueries& rays = sample.rays;
  const auto view = std::int32_t(field.views.size());
  field.views.push_back(
      {camera.name, sample.boundary.box, rays.grid.rows, rays.grid.cols, rays.samples, sample.boundary.mean_distance});
  const std::size_t queries = rays.depth.size();
  field.position.insert(field.position.end(), rays.position.begin(), rays.position.end());
  field.depth.insert(field.depth.end(), rays.depth.begin(), rays.depth.end());
  field.view.insert(field.view.end(), queries, view);
  for (std::size_t i = 0; i < queries; ++i) {
    const std::size_t ray = i / std::size_t(rays.samples);
    field.uv.insert(field.uv.end(), {rays.pixel[ray * 2], rays.pixel[ray * 2 + 1]});
    field.slot.push_back(std::int32_t(i));
  }
}

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

std::int64_t most_queries(const SampleOptions& options, std::size_t views) {
  return std::int64_t(views) * options.rows * options.cols * options.depth_samples;
}

RayOptions ray_options(const SampleOptions& options, double mean_distance) {
  return {.samples = options.depth_samples,
          .depth_span = options.depth_span,
          .depth_epsilon = kDepthEpsilon * options.world_unit,
          .mean_distance = mean_distance,
          .near_z = kNearZ * options.world_unit};
}

ViewSample sample_view(const Exec& exec, const SampleOptions& options, const Camera& camera,
                       Rows<const float, 3> boundary, const DepthMap& map) {
  ViewSample sample;
  sample.boundary = boundary_box(camera, boundary, options.bbox_pad_px, options.world_unit);
  if (options.whole_image && sample.boundary.visible > 0)
    sample.boundary.box = {0, 0, double(camera.width_px), double(camera.height_px)};
  const PixelGrid grid = pixel_grid(sample.boundary.box, options.rows, options.cols);
  sample.rays = ray_queries(exec, camera, grid, ray_options(options, sample.boundary.mean_distance), map);
  return sample;
}

QueryField sample_queries(const Exec& exec, Monitor& monitor, const SampleOptions& options, const SampleInputs& in) {
  const GaussianCloud& cloud = in.cloud;
  const BoundarySet& boundary = in.boundary;
  auto timed = monitor.scope("sample");
  QueryField field;
  field.origin = cloud.origin;
  field.depth_span = options.depth_span, field.depth_epsilon = kDepthEpsilon * options.world_unit;
  for (std::size_t n = 0; n < in.views.size(); ++n) {
    const Camera& world = in.scene.views[in.views[n]].camera;
    const Camera camera = relative_to(world, cloud.origin);
    RenderedView rendered;
    DepthMap map;
    if (boundary_box(camera, boundary.positions(), options.bbox_pad_px, options.world_unit).visible > 0) {
      rendered = render_depth(exec, cloud, world, in.splat);
      map = {&rendered.depth, &rendered.alpha};
    }
    append(sample_view(exec, options, camera, boundary.positions(), map), world, field);
    monitor.progress(std::int64_t(n) + 1, std::int64_t(in.views.size()));
  }
  timed.items(field.size());
  return field;
}

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
  field.feature.clear(), field.neighbour.clear(), field.weight.clear();
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
