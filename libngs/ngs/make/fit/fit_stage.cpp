#include "ngs/make/fit/fit_stage.h"

#include <algorithm>
#include <cmath>

#include "ngs/capture/pose_check.h"
#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/math/median.h"
#include "ngs/math/sh.h"
#include "ngs/math/stable.h"
#include "ngs/math/world_unit.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/ops/splat/splat_options.h"
#include "ngs/problem/view_list.h"

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

RenderRequest fit_request(const FitOptions& options) {
  RenderRequest request;
  if (!options.background.empty()) request.background = parse_background(options.background);
  return request;
}

/// Log-linear from the initial to the final rate, as in 3DGS.
double position_lr(const FitOptions& options, std::int64_t step, double extent) {
  if (options.position_lr == 0) return 0;
  const double t = std::clamp(double(step) / options.steps, 0.0, 1.0);
  return extent * std::exp((1 - t) * std::log(options.position_lr) + t * std::log(options.position_lr_final));
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

FitSchedule resolved_schedule(const FitOptions& o) {
  const auto pick = [](int given, int derived) { return given > 0 ? given : std::max(1, derived); };
  return {pick(o.sh_every, std::min(1000, o.steps / 8)), pick(o.densify_from, std::min(500, o.steps / 10)),
          pick(o.densify_until, std::min(15000, o.steps / 2)),
          pick(o.densify_every, std::clamp(o.steps / 15, 10, 100))};
}

FitCost fit_cost(const FitOptions& options, std::span<const Camera> cameras, double photo_bytes) {
  double pixels = 0;
  for (const Camera& c : cameras) pixels += double(c.width_px) * c.height_px;
  const double per_view = cameras.empty() ? 0 : pixels / double(cameras.size()), gaussians = options.max_gaussians;
  constexpr double kSecondsPerPixel = 2.5e-7, kSecondsPerGaussian = 5e-7;  // of one step, forward and backward
  constexpr double kBytesPerPixel = 250, kFloatsPerParameter = 4;          // value, gradient, m, v
  const double parameters = 14 + 3 * sh_rest_count(options.sh_degree);
  return {options.steps * (kSecondsPerPixel * per_view + kSecondsPerGaussian * gaussians),
          (photo_bytes + kBytesPerPixel * per_view + 4 * kFloatsPerParameter * parameters * gaussians) / 1048576};
}

Fitter::Fitter(const FitOptions& options, std::span<const FitView> views, FitState state, std::uint64_t seed)
    : options_(options),
      schedule_(resolved_schedule(options)),
      views_(views),
      state_(std::move(state)),
      seed_(seed),
      extent_(scene_extent(views)),
      world_unit_(fit_world_unit(views)),
      focus_(nearest_to_axes(views)),
      pass_(SplatOptions{}) {
  for (std::size_t i = 0; i < views.size(); ++i)
    if (views[i].split == Split::kTrain) training_.push_back(i);
  if (training_.empty())
    throw Error(ErrorCode::kInconsistent, "fit: no training view with a photo, expected at least one",
                "give the photos to ngs-scene import --images, or hold out fewer views");
}

std::size_t Fitter::view_of_step() {
  const auto n = std::int64_t(training_.size());
  const std::int64_t epoch = state_.step / n;
  if (epoch != order_epoch_) {  // every view once per epoch, in an order that depends on seed and epoch alone
    order_ = shuffled(training_, seed_, std::uint64_t(epoch));
    order_epoch_ = epoch;
  }
  return order_[std::size_t(state_.step % n)];
}

void Fitter::start_pass(const Exec& exec, int degree) {
  pass_ = SplatPass(SplatOptions{});
  colour_gradient_ = {};  // the images of images_
  images_ = std::make_unique<ResidentResults>(exec);
  pass_ =
      SplatPass(SplatOptions{.antialiased = options_.antialiased, .max_sh_degree = degree, .world_unit = world_unit_},
                images_.get());
  pass_degree_ = degree;
}

void Fitter::to_device(const Exec& exec) {
  constexpr std::size_t kPhotoBytes = std::size_t(2) << 30;
  if (!arrays_) {
    arrays_ = std::make_unique<Resident>(exec);
    photos_ = std::make_unique<ResidentImages>(exec, kPhotoBytes);
  }
  if (!arrays_->waits()) return;
  GaussianCloud& cloud = state_.cloud;
  gradients_.resize(std::size_t(cloud.size()), std::size_t(cloud.rest_count()) * 3, 0);
  for (std::size_t g = 0; g < kGaussianGroups; ++g) {
    std::vector<float>& values = cloud.*kGroupColumns[g].value;
    AdamMoments& moments = state_.moments[g];
    moments.m.resize(values.size());
    moments.v.resize(values.size());
    for (std::vector<float>* array : {&values, &(gradients_.*kGroupColumns[g].gradient), &moments.m, &moments.v})
      arrays_->add(*array);
  }
  arrays_->add(cloud.usable);
  arrays_->add(gradients_.mean_px);
  arrays_->add(gradients_.visible);
  arrays_->add(state_.gradient_sum);
  arrays_->add(state_.gradient_views);
}

void Fitter::step(const Exec& exec) {
  const std::size_t at = view_of_step();
  const FitView& view = views_[at];
  const int degree = int(std::min<std::int64_t>(options_.sh_degree, state_.step / schedule_.sh_every));
  if (degree != pass_degree_) start_pass(exec, degree);
  to_device(exec);
  ImageF scratch;
  const ImageF& photo = photos_->get(at, scratch, [&] { return view.photo.rgb(); });
  const RenderedView& rendered = pass_.forward(exec, state_.cloud, view.camera, fit_request(options_));
  images_->shape(colour_gradient_, rendered.width_px, rendered.height_px, 3);
  const auto loss =
      photometric_.evaluate(exec, {.dssim_weight = options_.dssim_weight}, {rendered.colour, photo}, &colour_gradient_);
  last_loss_ = {loss.total, loss.l1, loss.ssim};
  ViewGradients back;
  back.colour = std::move(colour_gradient_);
  pass_.backward(exec, back, gradients_);
  colour_gradient_ = std::move(back.colour);

  ++state_.step;
  update_parameters(exec);
  fade_near(exec, view.camera);
  if (state_.step > schedule_.densify_until) return;
  accumulate_gradients(exec, view.camera);
  if (state_.step > schedule_.densify_from && state_.step % schedule_.densify_every == 0) {
    arrays_->release();
    const bool after_reset = state_.step > options_.opacity_reset_every;
    const DensityRule rule{options_.densify_gradient, options_.dense_fraction * extent_, options_.min_opacity,
                           after_reset ? options_.max_scale_fraction * extent_ : 0, options_.max_gaussians};
    densify_and_prune(exec, state_, rule, rng_bits(seed_, RngStream::kSplit, std::uint64_t(state_.step)));
  }
  if (state_.step % options_.opacity_reset_every == 0 && state_.step < schedule_.densify_until) reset_opacity();
}

void Fitter::update_parameters(const Exec& exec) {
  const FitOptions& o = options_;
  const GroupRates rates{position_lr(o, state_.step, extent_), o.rotation_lr, o.scale_lr, o.opacity_lr, o.dc_lr,
                         pass_degree_ > 0 ? o.rest_lr : 0.0};
  step_gaussians(exec, {state_.step, rates}, gradients_, state_.cloud, state_.moments);
}

void Fitter::accumulate_gradients(const Exec& exec, const Camera& camera) {
  // 3DGS's threshold refers to normalised device coordinates, which span 2 over the image.
  const float per_ndc_x = 0.5f * float(camera.width_px), per_ndc_y = 0.5f * float(camera.height_px);
  for_each_row(exec, state_.cloud.size(),
               AddProjectedGradients{gradients_.visible.data(), gradients_.mean_px.data(), per_ndc_x, per_ndc_y,
                                     state_.gradient_sum.data(), state_.gradient_views.data()});
}

void Fitter::fade_near(const Exec& exec, const Camera& camera) {
  if (options_.near_loss == 0) return;
  const Vec3<double> centre = camera.centre(), to = focus_ - centre;
  const double reach = options_.near_reach * length(to);
  if (!(reach > 0)) return;
  for_each_row(exec, state_.cloud.size(),
               FadeNear{gradients_.visible.data(), state_.cloud.position.data(), centre, reach, options_.near_loss,
                        state_.cloud.logit_opacity.data()});
}

void Fitter::reset_opacity() {
  arrays_->release();
  const float most = logit(0.01f);
  for (float& o : state_.cloud.logit_opacity) o = std::min(o, most);
  state_.moments[kGroupOpacity] = {};
}

void run_fit(const Exec& exec, Monitor& monitor, Fitter& fitter, const FitOptions& options,
             const std::function<void(const Fitter&)>& every) {
  auto scope = monitor.scope("fit");
  const std::int64_t first = fitter.steps_done();
  while (fitter.steps_done() < options.steps && !monitor.stop_requested()) {
    fitter.step(exec);
    if (every) every(fitter);
    monitor.progress(fitter.steps_done(), options.steps);
  }
  scope.items(fitter.steps_done() - first);
}

FitScore score_fit(const Exec& exec, const FitOptions& options, const GaussianCloud& cloud,
                   std::span<const FitView> views, Split split) {
  FitScore score;
  const SplatOptions splat = prepared_for(
      exec,
      {.antialiased = options.antialiased, .max_sh_degree = options.sh_degree, .world_unit = fit_world_unit(views)},
      cloud);
  for (const FitView& view : views) {
    if (view.split != split) continue;
    ImageF colour = std::move(render(exec, cloud, view.camera, splat, fit_request(options)).colour);
    for (float& c : colour.data) c = std::clamp(c, 0.f, 1.f);
    const ImageF photo = view.photo.rgb();
    score.psnr_db += psnr_db(exec, colour, photo);
    score.ssim += ssim_index(exec, colour, photo);
    ++score.views;
  }
  if (score.views > 0) {
    score.psnr_db /= score.views;
    score.ssim /= score.views;
  }
  return score;
}

}  // namespace ngs
