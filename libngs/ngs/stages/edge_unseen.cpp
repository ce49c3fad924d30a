#include "ngs/stages/edge_unseen.h"

#include <map>
#include <memory>

#include "ngs/stages/effect_detectors.h"

namespace ngs {

std::vector<std::size_t> judges_of(const std::vector<std::size_t>& views) {
  std::vector<std::size_t> judges;
  if (views.size() < 5) return judges;
  for (std::size_t i = 1; i < views.size(); i += 3) judges.push_back(views[i]);
  return judges;
}

MethodInput with_pictures(const Exec& exec, const MethodInput& input, const GaussianCloud& cloud, const std::vector<std::size_t>& views) {
  auto pictures = std::make_shared<std::map<std::size_t, ImageF>>();
  RenderRequest request;
  request.background = input.background;
  for (const std::size_t v : views)
    (*pictures)[v] = render(exec, cloud, input.scene.views[v].camera, input.splat, request).colour;
  MethodInput out = input;
  const auto instead_of = [&](const auto& load) {
    return [pictures, load](std::size_t v) {
      const auto found = pictures->find(v);
      return found != pictures->end() ? found->second : load(v);
    };
  };
  out.load_photo = instead_of(input.load_photo), out.load_fine_photo = instead_of(input.load_fine_photo);
  return out;
}

Trial try_pictures(const Exec& exec, const WalkSetup& setup, const LabelledModel& before, const LabelledModel& after,
                   const std::vector<WalkedView>& in_photos, const std::vector<std::size_t>& judges) {
  const auto judged = [&](MethodInput input, const LabelledModel& model) {
    input.load_masks = [&](std::size_t v) {
      const Camera& camera = input.scene.views[v].camera;
      return whole_masks(in_photos[v], camera.width_px, camera.height_px);
    };
    return walk_views(exec, {setup.walk, setup.margin_px, input, setup.detail}, model, judges, judges);
  };
  const std::vector<WalkedView> pictured = judged(with_pictures(exec, setup.input, before.cloud, judges), before),
                                unseen = judged(setup.input, after);
  Trial trial;
  std::vector<double> gains;
  for (const std::size_t v : judges) {
    gains.push_back(pictured[v].walked_biou - unseen[v].rendered_biou);
    trial.pictured += pictured[v].walked_biou / double(judges.size());
    trial.unseen += unseen[v].rendered_biou / double(judges.size());
  }
  trial.picture_serves = gain_in_errors(gains) > kSignificant;
  return trial;
}

}  // namespace ngs
