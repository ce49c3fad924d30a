#include "ngs/make/fit/photo_refit.h"

#include <algorithm>
#include <cmath>

#include "ngs/make/fit/fit_stage.h"
#include "ngs/ops/image/metrics.h"
#include "ngs/ops/losses/photometric.h"
#include "ngs/ops/optim/adam.h"
#include "ngs/ops/splat/evidence.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/problem/view_list.h"

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
    for (const std::uint32_t row : view_sums(exec, cloud, {camera, known_view(camera)}, splat).row) {
      seen[row] = 1;
      trained |= in.trained[row] != 0;
    }
    if (trained) visible.views.push_back(v);
  });
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i]) visible.rows.push_back(std::int64_t(i));
  return visible;
}

/// The optimisation steps, on a cloud whose rows are all visible. Until finish(), a device has the cloud's values.
class RefitSteps {
 public:
  RefitSteps(const Exec& exec, const RefitOptions& options, const RefitInputs& in, GaussianCloud& cloud)
      : exec_(exec),
        options_(options),
        in_(in),
        cloud_(cloud),
        extent_(scene_extent(cameras_of(in.problem.scene, photo_views(in.problem.scene)))),
        trained_(exec, in.trained, {}, cloud),
        fixed_shape_(trained_.size()),
        images_(exec),
        pass_(trained_.prepared(in.problem.splat), &images_),
        photos_(exec, kPhotoBytes),
        arrays_(exec) {
    for (std::size_t r = 0; r < fixed_shape_.size(); ++r) fixed_shape_[r] = !in.moves[trained_.row(r)];
  }

  std::int64_t planned() const { return std::int64_t(options_.epochs) * std::int64_t(in_.views.size()); }
  std::int64_t done() const { return done_; }

  void step(std::size_t v) {
    to_device();
    const Problem& input = in_.problem;
    RenderRequest request;
    request.background = input.background;
    const RenderedView& rendered = pass_.forward(exec_, cloud_, input.scene.views[v].camera, request);
    ImageF scratch;
    const ImageF& photo = photos_.get(v, scratch, [&] { return input.load_photo(v); });
    const ImageF weight = in_.weight ? in_.weight(v) : ImageF();
    images_.shape(gradient_.colour, rendered.width_px, rendered.height_px, rendered.colour.channels);
    photometric_.evaluate(exec_, {}, {rendered.colour, photo, in_.weight ? &weight : nullptr}, &gradient_.colour);
    pass_.backward(exec_, gradient_, gradients_, trained_.wanted());
    for_each_row(exec_, std::int64_t(trained_.size()),
                 ClearShapes{fixed_shape_.data(), gradients_.position.data(), gradients_.rotation.data(),
                             gradients_.log_scale.data(), gradients_.logit_opacity.data()});
    const double decay = std::pow(options_.decay, double(done_) / double(planned()));
    ++done_;
    GroupRates rates{options_.position_lr * extent_,
                     options_.rotation_lr,
                     options_.scale_lr,
                     options_.opacity_lr,
                     options_.dc_lr,
                     options_.rest_lr};
    for (double& rate : rates) rate *= decay;
    step_gaussians(exec_, {done_, rates}, gradients_, trained_.cloud(), moments_);
    trained_.write_back(exec_);
  }

  void finish() { arrays_.release(); }

 private:
  static constexpr std::size_t kPhotoBytes = 512u << 20;

  void to_device() {
    if (!arrays_.waits()) return;
    gradients_.resize(trained_.size(), std::size_t(cloud_.rest_count()) * 3, 0);
    for (std::size_t g = 0; g < kGaussianGroups; ++g) {
      std::vector<float>& gradient = gradients_.*kGroupColumns[g].gradient;
      moments_[g].m.resize(gradient.size());
      moments_[g].v.resize(gradient.size());
      for (std::vector<float>* array : {&gradient, &moments_[g].m, &moments_[g].v}) arrays_.add(*array);
    }
    arrays_.add(gradients_.mean_px);
    arrays_.add(gradients_.visible);
    arrays_.add(fixed_shape_);
    trained_.add_to(arrays_);
  }

  const Exec& exec_;
  const RefitOptions& options_;
  const RefitInputs& in_;
  GaussianCloud& cloud_;
  double extent_;
  TrainedRows trained_;
  std::vector<std::uint8_t> fixed_shape_;  // [trained rows] 1: only the colour is trained
  ResidentResults images_;                 // of pass_, and gradient_
  SplatPass pass_;
  ViewGradients gradient_;
  ResidentImages photos_;
  PhotometricPass<float> photometric_;
  CloudGradients gradients_;
  GaussianMoments moments_;
  std::int64_t done_ = 0;
  Resident arrays_;  // of a step
};

void train(const Exec& exec, Monitor& monitor, const RefitOptions& options, const RefitInputs& in,
           GaussianCloud& cloud) {
  RefitSteps steps(exec, options, in, cloud);
  for (int epoch = 0; epoch < options.epochs; ++epoch)
    for (const std::size_t v : shuffled(in.views, in.problem.seed, std::uint64_t(epoch))) {
      if (monitor.stop_requested()) return steps.finish();
      steps.step(v);
      monitor.progress(steps.done(), steps.planned());
    }
  steps.finish();
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
