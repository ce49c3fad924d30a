#include "object_output.h"

#include <algorithm>
#include <filesystem>

#include "ngs/edit/finish/finish_stage.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/masks.h"
#include "ngs/math/row_numbers.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/render/render_options.h"

namespace ngs::cli {
namespace {

constexpr std::size_t kMaxViews = 40;  // evenly spread over the scene's: more change little

using Rows = std::vector<std::uint8_t>;  // [N] 1: of the object

/// Each chosen object alone.
std::vector<Rows> objects_of(const Extractor& extractor) {
  const std::vector<const io::NamedLabels*> chosen = extractor.chosen();
  if (chosen.size() == 1) return {extractor.object()};
  std::vector<Rows> objects;
  for (const io::NamedLabels* labels : chosen)
    objects.emplace_back(labels->columns.label.begin(), labels->columns.label.end());
  return objects;
}

/// Index in the scene of each chosen object; -1: the scene lacks it.
std::vector<int> indices_in(const Scene& scene, const Extractor& extractor) {
  std::vector<int> found;
  for (const io::NamedLabels* object : extractor.chosen()) {
    const auto at = std::ranges::find(scene.objects, object->object, &SceneObject::name);
    found.push_back(at == scene.objects.end() ? -1 : int(at - scene.objects.begin()));
  }
  return found;
}

ViewMasks training_masks(const Scene& scene, std::size_t view) {
  if (scene.views[view].split != Split::kTrain || scene.views[view].mask_path.empty()) return {};
  return io::load_masks(scene, view);
}

/// The mask of an object as SupportView needs it; empty if the view has none for training.
std::vector<finish::GivenMask> given_mask(const ViewMasks& masks, int object) {
  if (!masks.available || object < 0) return {};
  const auto& target = masks.target[std::size_t(object)];
  std::vector<finish::GivenMask> given(target.size(), finish::GivenMask::kBackground);
  for (std::size_t p = 0; p < given.size(); ++p) {
    if (mask_is_foreground(target[p])) given[p] = finish::GivenMask::kObject;
    if (!masks.known.empty() && !masks.known[p]) given[p] = finish::GivenMask::kUnknown;
  }
  return given;
}

/// What each view contains about each object: [objects][views].
std::vector<std::vector<finish::SupportView>> support_views(Run& run, const Extractor& extractor, const Scene& scene,
                                                            const std::vector<Rows>& objects) {
  const GaussianCloud& cloud = extractor.cloud();
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene), cloud);
  const std::vector<int> indices = indices_in(scene, extractor);
  const finish::ObjectLabels labels(cloud, objects);
  std::vector<std::vector<finish::SupportView>> views(objects.size());
  const std::size_t count = std::min(scene.views.size(), kMaxViews);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t v = i * scene.views.size() / count;
    const Camera& camera = scene.views[v].camera;
    const RenderedView rendered = labels.render(run.exec(), splat, camera);
    const ViewMasks masks = training_masks(scene, v);
    for (std::size_t k = 0; k < objects.size(); ++k)
      views[k].emplace_back(finish::FinishModel{cloud, objects[k]}, camera, finish::RenderedObject{rendered, int(k)},
                            given_mask(masks, indices[k]));
    run.monitor().progress(std::int64_t(i + 1), std::int64_t(count));
  }
  return views;
}

/// Clips the objects. Returns the model with their clipped Gaussians; takes those without support from `objects`.
GaussianCloud finished_model(Run& run, const Extractor& extractor, const Scene& scene, std::vector<Rows>& objects) {
  const auto timed = run.monitor().scope("finish");
  const std::vector<std::vector<finish::SupportView>> views = support_views(run, extractor, scene, objects);
  GaussianCloud model = extractor.cloud();
  std::int64_t clipped = 0, dropped = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    finish::Finished found = finish::finish_object(
        run.exec(), {{extractor.cloud(), objects[k]}, views[k], splat_options({}, model, scene), run.seed()});
    scatter_rows(run.exec(), found.object, RowNumbers(objects[k]).row, model);
    objects[k] = std::move(found.keep);
    clipped += found.clipped;
    dropped += found.dropped;
  }
  run.result()["finish"] = {{"clipped", clipped}, {"dropped", dropped}};
  run.text("finished the object: " + std::to_string(clipped) + " Gaussians clipped, " + std::to_string(dropped) +
           " left out\n");
  return model;
}

}  // namespace

void write_objects(Run& run, const Extractor& extractor, const Scene* scene, const Outputs& out) {
  if (!out.object && !out.objects) return;
  std::vector<Rows> objects = objects_of(extractor);
  GaussianCloud finished;
  if (scene != nullptr) finished = finished_model(run, extractor, *scene, objects);
  const auto write = [&](const std::string& path, const Rows& keep) {
    const GaussianCloud* edited = scene != nullptr ? &finished : nullptr;
    for (const std::string& note : io::write_splat(path, {extractor.model(), keep, edited, extractor.up()}))
      run.monitor().warn(note);
  };
  Rows any(extractor.object().size());
  for (std::size_t k = 0; k < objects.size(); ++k) {
    for (std::size_t i = 0; i < any.size(); ++i) any[i] |= objects[k][i];
    if (!out.objects || objects.size() < 2) continue;
    std::filesystem::create_directories(out.objects.path);
    write(out.objects.path + "/" + extractor.chosen()[k]->object + ".ply", objects[k]);
  }
  if (out.object) write(out.object.path, any);
}

}  // namespace ngs::cli
