#include "ngs/stages/fit/photo_refit.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/image/image_metrics.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/problem/view_list.h"
#include "ngs/stages/fit/fit_stage.h"

namespace ngs {

double mean_psnr_db(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                    const std::vector<std::size_t>& views) {
  double sum = 0;
  const SplatOptions splat = prepared_for(exec, input.splat, cloud);
  for_each_view(input.monitor, views, [&](std::size_t, std::size_t v) {
    RenderRequest request;
    request.background = input.background;
    ImageF colour = std::move(render(exec, cloud, input.scene.views[v].camera, splat, request).colour);
    for (float& c : colour.data) c = std::clamp(c, 0.f, 1.f);
    sum += psnr_db(exec, colour, input.load_photo(v));
  });
  return views.empty() ? 0 : sum / double(views.size());
}

namespace {

struct Visible {
  std::vector<std::int64_t> rows;  // with weight in some pixel of a view, ascending; occluded rows have no gradient
  std::vector<std::size_t> views;  // in which a trained row is visible
};

Visible visible_in(const Exec& exec, const RefitInputs& in, const GaussianCloud& cloud) {
  Visible visible;
  std::vector<std::uint8_t> seen(std::size_t(cloud.size()), 0);
  const SplatOptions splat = prepared_for(exec, in.problem.splat, cloud);
  for_each_view(in.problem.monitor, in.views, [&](std::size_t, std::size_t v) {
    const Camera& camera = in.problem.scene.views[v].camera;
    bool trained = false;
    for (const std::uint32_t row : view_sums(exec, cloud, {camera, known_view(camera)}, splat).row)
      seen[row] = 1, trained |= in.trained[row] != 0;
    if (trained) visible.views.push_back(v);
  });
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i]) visible.rows.push_back(std::int64_t(i));
  return visible;
}

/// The optimisation steps, on a cloud whose rows are all visible.
void train(const Exec& exec, Monitor& monitor, const RefitOptions& options, const RefitInputs& in,
           GaussianCloud& cloud) {
  const Problem& input = in.problem;
  const double extent = scene_extent(cameras_of(input.scene, photo_views(input.scene)));
  const std::int64_t steps = std::int64_t(options.epochs) * std::int64_t(in.views.size());
  TrainedRows trained(exec, in.trained, {}, cloud);
  std::vector<std::uint8_t> fixed_shape(trained.size()), fixed_colour(trained.size());
  for (std::size_t r = 0; r < fixed_shape.size(); ++r) {
    const std::size_t row = trained.row(r);
    fixed_colour[r] = !in.trained[row], fixed_shape[r] = fixed_colour[r] || !in.moves[row];
  }
  SplatPass pass(trained.prepared(input.splat));
  PhotometricPass<float> photometric;
  CloudGradients gradients;
  ViewGradients image;
  GaussianMoments moments;
  std::int64_t step = 0;
  for (int iteration = 0; iteration < options.epochs; ++iteration)
    for (const std::size_t v : shuffled(in.views, input.seed, std::uint64_t(iteration))) {
      if (monitor.stop_requested()) return;
      RenderRequest request;
      request.background = input.background;
      const RenderedView& rendered = pass.forward(exec, cloud, input.scene.views[v].camera, request);
      const ImageF photo = input.load_photo(v), weight = in.weight ? in.weight(v) : ImageF();
      photometric.evaluate(exec, {}, {rendered.colour, photo, in.weight ? &weight : nullptr}, &image.colour);
      pass.backward(exec, image, gradients, trained.wanted());
      clear_shapes(fixed_shape, gradients), clear_colours(fixed_colour, gradients);
      const double decay = std::pow(options.decay, double(step) / double(steps));
      ++step;
      GroupRates rates{options.position_lr * extent, options.rotation_lr, options.scale_lr,
                       options.opacity_lr,           options.dc_lr,       options.rest_lr};
      for (double& rate : rates) rate *= decay;
      step_gaussians(exec, {step, rates}, gradients, trained.cloud(), moments);
      trained.write_back(exec);
      monitor.progress(step, steps);
    }
}

}  // namespace

void refit_to_photos(const Exec& exec, Monitor& monitor, const RefitOptions& options, const RefitInputs& in,
                     GaussianCloud& cloud) {
  const Visible visible = visible_in(exec, in, cloud);
  const std::vector<std::uint8_t> moves = gather_column(exec, in.moves, 1, visible.rows),
                                  trained = gather_column(exec, in.trained, 1, visible.rows);
  GaussianCloud part = gather_rows(exec, cloud, visible.rows);
  train(exec, monitor, options, {in.problem, visible.views, moves, trained, in.weight}, part);
  scatter_rows(exec, part, visible.rows, cloud);
}

}  // namespace ngs
