#include "finish_output.h"

#include <algorithm>

#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/masks.h"
#include "ngs/stages/render/render_options.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kMaxViews = 64;  // evenly spread over the scene's: more change little

/// Indices in the scene of the extracted objects; empty if the scene lacks one of them.
std::vector<std::size_t> objects_in(const Scene& scene, const Extractor& extractor) {
  std::vector<std::size_t> found;
  for (const io::NamedLabels* object : extractor.chosen()) {
    const auto at = std::ranges::find(scene.objects, object->object, &SceneObject::name);
    if (at == scene.objects.end()) return {};
    found.push_back(std::size_t(at - scene.objects.begin()));
  }
  return found;
}

/// The union of the objects' masks of a view as SupportView::Input needs it; empty if the view has none for training.
std::vector<finish::GivenMask> given_mask(const Scene& scene, std::size_t view,
                                          const std::vector<std::size_t>& objects) {
  if (objects.empty() || scene.views[view].split != Split::kTrain || scene.views[view].mask_path.empty()) return {};
  const ViewMasks masks = io::load_masks(scene, view);
  if (!masks.available) return {};
  std::vector<finish::GivenMask> given(masks.target[0].size(), finish::GivenMask::kBackground);
  for (std::size_t p = 0; p < given.size(); ++p) {
    for (const std::size_t k : objects)
      if (mask_is_foreground(masks.target[k][p])) given[p] = finish::GivenMask::kObject;
    if (!masks.known.empty() && !masks.known[p]) given[p] = finish::GivenMask::kUnknown;
  }
  return given;
}

}  // namespace

void check_finish_options(const finish::FinishOptions& options, const Output& object, const Input& scene) {
  if (!options.finish) return;
  if (!scene) throw Error(ErrorCode::kUsage, "--finish needs the cameras", "give --scene scene.json");
  if (!object) throw Error(ErrorCode::kUsage, "--finish changes only the object", "give --object-ply FILE");
}

void write_finished(Run& run, const Extractor& extractor, const Scene& scene, const std::string& path) {
  const auto timed = run.monitor().scope("finish");
  const finish::FinishModel model{extractor.cloud(), extractor.object()};
  const std::vector<std::size_t> objects = objects_in(scene, extractor);
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, model.cloud, scene), model.cloud);
  std::vector<finish::SupportView> views;
  const std::size_t count = std::min(scene.views.size(), kMaxViews);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t v = k * scene.views.size() / count;
    const std::vector<finish::GivenMask> given = given_mask(scene, v, objects);
    views.emplace_back(run.exec(), model, splat, finish::SupportView::Input{scene.views[v].camera, given});
    run.monitor().progress(std::int64_t(k + 1), std::int64_t(count));
  }
  const finish::Finished found = finish::finish_object(run.exec(), model, views, run.seed());
  run.result()["finish"] = {{"clipped", found.clipped}, {"dropped", found.dropped}};
  for (const std::string& note : io::write_splat(path, {extractor.model(), found.keep, &found.cloud, extractor.up()}))
    run.monitor().warn(note);
}

}  // namespace ngs::cli
