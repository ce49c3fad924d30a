#include "ngs/field/sample_stage.h"

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
  field.depth_span = options.depth_span;
  field.depth_epsilon = kDepthEpsilon * options.world_unit;
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

}  // namespace ngs
