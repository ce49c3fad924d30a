#include "ngs/stages/contours/photoless_views.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "ngs/problem/scene_measures.h"
#include "ngs/problem/view_list.h"

namespace ngs {

std::vector<std::size_t> judges_of(const std::vector<std::size_t>& views) {
  std::vector<std::size_t> judges;
  if (views.size() < 5) return judges;
  for (std::size_t i = 1; i < views.size(); i += 3) judges.push_back(views[i]);
  return judges;
}

namespace {

/// Renderings of a model in some views.
class Pictures {
 public:
  Pictures(const Exec& exec, const Problem& input, const GaussianCloud& cloud, const std::vector<std::size_t>& views,
           std::size_t cache_bytes)
      : exec_(exec), scene_(input.scene), splat_(input.splat) {
    request_.background = input.background;
    for_each_view(input.monitor, views, [&](std::size_t, std::size_t v) {
      const Camera& camera = scene_.views[v].camera;
      const std::size_t bytes = 3 * sizeof(float) * std::size_t(camera.width_px) * std::size_t(camera.height_px);
      std::optional<ImageF>& picture = picture_[v];
      if (bytes > cache_bytes) return;
      cache_bytes -= bytes;
      picture = drawn(cloud, v);
    });
    if (std::any_of(picture_.begin(), picture_.end(), [](const auto& of_view) { return !of_view.second; }))
      model_ = cloud;
  }

  bool has(std::size_t v) const { return picture_.contains(v); }
  ImageF of(std::size_t v) const {
    const std::optional<ImageF>& picture = picture_.at(v);
    return picture ? *picture : drawn(model_, v);
  }

 private:
  ImageF drawn(const GaussianCloud& cloud, std::size_t v) const {
    return render(exec_, cloud, scene_.views[v].camera, splat_, request_).colour;
  }

  Exec exec_;
  const Scene& scene_;
  SplatOptions splat_;
  RenderRequest request_;
  std::map<std::size_t, std::optional<ImageF>> picture_;  // by view; nullopt: rendered at every load
  GaussianCloud model_;                                   // empty if all renderings are cached
};

}  // namespace

Problem with_pictures(const Exec& exec, const Problem& input, const GaussianCloud& cloud,
                      const std::vector<std::size_t>& views, std::size_t cache_bytes) {
  const auto pictures = std::make_shared<const Pictures>(exec, input, cloud, views, cache_bytes);
  Problem out = input;
  const auto instead_of = [&](const auto& load) {
    return [pictures, load](std::size_t v) { return pictures->has(v) ? pictures->of(v) : load(v); };
  };
  out.load_photo = instead_of(input.load_photo), out.load_fine_photo = instead_of(input.load_fine_photo);
  return out;
}

Trial try_pictures(const Exec& exec, const RefineSetup& setup, const TriedIteration& tried,
                   const std::vector<RefinedView>& in_photos, const std::vector<std::size_t>& judges) {
  const auto judged = [&](Problem input, const LabelledModel& model) {
    input.load_masks = [&](std::size_t v) {
      const Camera& camera = input.scene.views[v].camera;
      return whole_masks(in_photos[v], camera.width_px, camera.height_px);
    };
    return refine_views(exec, {setup.refine, setup.margin_px, input, setup.detail}, model, judges, judges);
  };
  const std::vector<RefinedView> pictured = judged(with_pictures(exec, setup.problem, tried.before.cloud, judges),
                                                   tried.before),
                                 skipped = judged(setup.problem, tried.after);
  Trial trial;
  std::vector<double> gains;
  for (const std::size_t v : judges) {
    gains.push_back(pictured[v].refined_biou - skipped[v].rendered_biou);
    trial.pictured += pictured[v].refined_biou / double(judges.size());
    trial.skipped += skipped[v].rendered_biou / double(judges.size());
  }
  trial.picture_serves = gain_in_errors(gains) > kSignificant;
  return trial;
}

}  // namespace ngs
