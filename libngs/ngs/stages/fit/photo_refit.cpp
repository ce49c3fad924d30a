#include "ngs/stages/fit/photo_refit.h"

#include <algorithm>
#include <cmath>

#include "ngs/ops/image/image_metrics.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/view_list.h"
#include "ngs/stages/fit/fit_stage.h"

namespace ngs {

double mean_psnr_db(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                    const std::vector<std::size_t>& views) {
  double sum = 0;
  for_each_view(input.monitor, views, [&](std::size_t, std::size_t v) {
    RenderRequest request;
    request.background = input.background;
    ImageF colour = std::move(render(exec, cloud, input.scene.views[v].camera, input.splat, request).colour);
    for (float& c : colour.data) c = std::clamp(c, 0.f, 1.f);
    sum += psnr_db(exec, colour, input.load_photo(v));
  });
  return views.empty() ? 0 : sum / double(views.size());
}

void refit_to_photos(const Exec& exec, Monitor& monitor, const RefitOptions& options, const RefitInputs& in,
                     GaussianCloud& cloud) {
  const Problem& input = in.problem;
  const std::vector<std::size_t>& views = in.views;
  const double extent = scene_extent(cameras_of(input.scene, views));
  const std::int64_t steps = std::int64_t(options.epochs) * std::int64_t(views.size());
  std::vector<std::uint8_t> still(in.moves.size());
  for (std::size_t i = 0; i < still.size(); ++i) still[i] = !in.moves[i];
  SplatPass pass(input.splat);
  PhotometricPass<float> photometric;
  CloudGradients gradients;
  ViewGradients image;
  GaussianMoments moments;
  std::int64_t step = 0;
  for (int iteration = 0; iteration < options.epochs; ++iteration)
    for (const std::size_t v : shuffled(views, input.seed, std::uint64_t(iteration))) {
      if (monitor.stop_requested()) return;
      RenderRequest request;
      request.background = input.background;
      const RenderedView& rendered = pass.forward(exec, cloud, input.scene.views[v].camera, request);
      photometric.evaluate(exec, {}, {rendered.colour, input.load_photo(v)}, &image.colour);
      pass.backward(exec, image, gradients);
      clear_shapes(still, gradients);
      const double decay = std::pow(options.decay, double(step) / double(steps));
      ++step;
      GroupRates rates{options.position_lr * extent, options.rotation_lr, options.scale_lr,
                       options.opacity_lr,           options.dc_lr,       options.rest_lr};
      for (double& rate : rates) rate *= decay;
      step_gaussians(exec, {step, rates}, gradients, cloud, moments);
      monitor.progress(step, steps);
    }
}

}  // namespace ngs
