#include <algorithm>
#include <cmath>

#include "ngs/capture/pose_check.h"
#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/make/fit/fit_stage.h"
#include "ngs/math/median.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/splat/splat_options.h"

namespace ngs {
namespace {

std::vector<Camera> training_cameras(std::span<const FitView> views) {
  std::vector<Camera> training;
  for (const FitView& view : views)
    if (view.split == Split::kTrain) training.push_back(view.camera);
  return training;
}

/// Throws if most points are nearer than the near plane: renders would stay empty and no gradient would change that.
void require_visible(const GaussianCloud& cloud, std::span<const FitView> views) {
  const double near =
      share_too_near(cloud, training_cameras(views), near_plane(Compat::kInria) * fit_world_unit(views));
  if (near > kTooNear)
    throw Error(
        ErrorCode::kInconsistent,
        "fit: " + std::to_string(std::lround(100 * near)) +
            " % of the points in front of the median camera are nearer than the near plane, expected at most half",
        kTooNearRemedy);
}

std::vector<FitPoint> random_cube(const FitOptions& options, std::span<const FitView> views, std::uint64_t seed) {
  const double extent = scene_extent(views);
  const Vec3<double> middle = nearest_to_axes(views);
  std::vector<FitPoint> points(std::size_t(options.random_points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto draw = [&](std::uint64_t k) { return rng_uniform(seed, RngStream::kFitInit, 8 * i + k); };
    const auto coordinate = [&](double at, std::uint64_t k) { return float(at + 1.3 * extent * (2 * draw(k) - 1)); };
    points[i] = {{coordinate(middle.x, 0), coordinate(middle.y, 1), coordinate(middle.z, 2)},
                 {float(draw(3)), float(draw(4)), float(draw(5))}};
  }
  return points;
}

/// At most `most` points, evenly spaced in the list. The first points of COLMAP come from the first photos, which show
/// one side of the scene, so taking a prefix would not cover the scene.
std::vector<FitPoint> subsampled(std::vector<FitPoint> points, std::size_t most) {
  if (points.size() <= most) return points;
  for (std::size_t i = 0; i < most; ++i) points[i] = points[i * points.size() / most];
  points.resize(most);
  return points;
}

}  // namespace

double scene_extent(std::span<const Camera> cameras) {
  Vec3<double> mean{0, 0, 0};
  double farthest = 0;
  for (const Camera& camera : cameras) mean = mean + camera.centre();
  mean = (1 / std::max(1.0, double(cameras.size()))) * mean;
  for (const Camera& camera : cameras) farthest = std::max(farthest, length(camera.centre() - mean));
  return farthest > 0 ? 1.1 * farthest : 1.0;
}

double scene_extent(std::span<const FitView> views) { return scene_extent(training_cameras(views)); }

Vec3<double> nearest_to_axes(std::span<const FitView> views) {
  constexpr double kRegularisation = 1e-3;
  std::vector<Camera> cameras;
  for (const FitView& view : views) cameras.push_back(view.camera);
  return point_nearest_to_axes(cameras, {kRegularisation, scene_extent(views)}).value_or(Vec3<double>{0, 0, 0});
}

double fit_world_unit(std::span<const FitView> views) {
  const Vec3<double> middle = nearest_to_axes(views);
  std::vector<double> distances;
  for (const FitView& view : views) distances.push_back(length(middle - view.camera.centre()));
  if (distances.empty()) return 1;
  return world_unit_for(0.5 * upper_median(std::move(distances)), near_plane(Compat::kInria));
}

FitState initial_fit(const Exec& exec, const FitOptions& options, std::span<const FitPoint> points,
                     std::span<const FitView> views, std::uint64_t seed) {
  std::vector<FitPoint> start(points.begin(), points.end());
  if (start.empty()) start = random_cube(options, views, seed);
  start = subsampled(std::move(start), std::size_t(options.max_gaussians));
  FitState state;
  GaussianCloud& cloud = state.cloud;
  cloud.resize(std::int64_t(start.size()), options.sh_degree);
  cloud.antialiased = options.antialiased;
  for (std::size_t i = 0; i < start.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      if (!std::isfinite(start[i].position[k]) || !std::isfinite(start[i].rgb[k]))
        throw Error(ErrorCode::kBadInput,
                    "point " + std::to_string(i) + " is not finite, expected a position and a colour");
      cloud.position[3 * i + k] = start[i].position[k];
      cloud.sh_dc[3 * i + k] = dc_of_colour(start[i].rgb[k]);
    }
  const KnnGraph near = nearest_others(exec, {cloud.position.data(), cloud.size()}, 3);
  const float single_scale = float(0.01 * scene_extent(views));  // a single point has no neighbours
  const double world_unit = fit_world_unit(views), min_dist2 = 1e-7 * world_unit * world_unit;  // 3DGS's lower bound
  for (std::size_t i = 0; i < start.size(); ++i) {
    double mean = 0;
    for (int k = 0; k < near.neighbours; ++k)
      mean += double(near.dist2[i * std::size_t(near.neighbours) + std::size_t(k)]) / near.neighbours;
    const float log_scale =
        near.neighbours > 0 ? float(0.5 * std::log(std::max(mean, min_dist2))) : log_of(single_scale);
    std::fill_n(cloud.log_scale.begin() + std::ptrdiff_t(3 * i), 3, log_scale);
    cloud.rotation[4 * i] = 1;
    cloud.logit_opacity[i] = logit(0.1f);
  }
  state.gradient_sum.assign(start.size(), 0.f);
  state.gradient_views.assign(start.size(), 0.f);
  require_visible(cloud, views);
  return state;
}

}  // namespace ngs
