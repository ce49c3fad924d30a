#include "ngs/cut/contours/photoless_views.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"

namespace ngs {

std::vector<std::size_t> trial_views_of(const std::vector<std::size_t>& views) {
  std::vector<std::size_t> trial_views;
  if (views.size() < 5) return trial_views;
  for (std::size_t i = 1; i < views.size(); i += 3) trial_views.push_back(views[i]);
  return trial_views;
}

namespace {

/// Renderings of a model in some views.
class Renderings {
 public:
  Renderings(const Exec& exec, const Problem& input, const GaussianCloud& cloud, const std::vector<std::size_t>& views,
             std::size_t cache_bytes)
      : exec_(exec), scene_(input.scene), splat_(input.splat) {
    request_.background = input.background;
    const SplatOptions splat = prepared_for(exec, splat_, cloud);
    for_each_view(input.monitor, views, [&](std::size_t, std::size_t v) {
      const Camera& camera = scene_.views[v].camera;
      const std::size_t bytes = 3 * sizeof(float) * std::size_t(camera.width_px) * std::size_t(camera.height_px);
      std::optional<ImageF>& rendering = rendering_[v];
      if (bytes > cache_bytes) return;
      cache_bytes -= bytes;
      rendering = rendered(cloud, splat, v);
    });
    if (std::any_of(rendering_.begin(), rendering_.end(), [](const auto& of_view) { return !of_view.second; }))
      model_ = cloud;
  }

  bool has(std::size_t v) const { return rendering_.contains(v); }
  ImageF of(std::size_t v) const {
    const std::optional<ImageF>& rendering = rendering_.at(v);
    return rendering ? *rendering : rendered(model_, splat_, v);
  }

 private:
  ImageF rendered(const GaussianCloud& cloud, const SplatOptions& splat, std::size_t v) const {
    return render(exec_, cloud, scene_.views[v].camera, splat, request_).colour;
  }

  Exec exec_;
  const Scene& scene_;
  SplatOptions splat_;
  RenderRequest request_;
  std::map<std::size_t, std::optional<ImageF>> rendering_;  // by view; nullopt: rendered at every load
  GaussianCloud model_;                                     // empty if all renderings are cached
};

}  // namespace

Problem with_renderings(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                        const std::vector<std::size_t>& views, std::size_t cache_bytes) {
  const auto renderings = std::make_shared<const Renderings>(exec, input, cloud, views, cache_bytes);
  Problem out = input;
  const auto instead_of = [&](const auto& load) {
    return [renderings, load](std::size_t v) { return renderings->has(v) ? renderings->of(v) : load(v); };
  };
  out.load_photo = instead_of(input.load_photo);
  out.load_fine_photo = instead_of(input.load_fine_photo);
  return out;
}

Trial evaluate_trial(const Exec& exec, const RefineSetup& setup, const TrialIteration& iteration,
                     const std::vector<RefinedView>& in_photos, const std::vector<std::size_t>& trial_views) {
  const auto compared = [&](Problem input, const LabelledModel& model) {
    input.load_masks = [&](std::size_t v) {
      const Camera& camera = input.scene.views[v].camera;
      return uncropped_masks(in_photos[v], camera.width_px, camera.height_px);
    };
    return refine_views(exec, {setup.refine, setup.margin_px, input, setup.detail}, model, trial_views, trial_views);
  };
  const std::vector<RefinedView> pictured =
                                     compared(with_renderings(exec, setup.problem, iteration.before.cloud, trial_views),
                                              iteration.before),
                                 skipped = compared(setup.problem, iteration.after);
  Trial trial;
  std::vector<double> gains;
  for (const std::size_t v : trial_views) {
    gains.push_back(pictured[v].refined_biou - skipped[v].rendered_biou);
    trial.pictured += pictured[v].refined_biou / double(trial_views.size());
    trial.skipped += skipped[v].rendered_biou / double(trial_views.size());
  }
  trial.renderings_help = gain_in_standard_errors(gains) > kSignificant;
  return trial;
}

}  // namespace ngs
