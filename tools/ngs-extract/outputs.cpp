#include "outputs.h"

#include <cstdio>
#include <filesystem>
#include <iterator>

#include "ngs/edit/extract/unseen_surface.h"
#include "ngs/edit/finish/alone.h"
#include "ngs/edit/finish/finish_stage.h"
#include "ngs/edit/finish/mask_lack.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/npy.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/formats/write_splat.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/math/row_numbers.h"
#include "ngs/problem/cloud_rows.h"
#include "ngs/render/render_options.h"

namespace ngs::cli {
namespace {

// Below this fraction the unseen surface consists of thin gaps between seen parts.
constexpr double kWorthTelling = 0.02;

std::vector<std::uint8_t> seen_of(const LabelColumn& views) {
  std::vector<std::uint8_t> seen(views.size());
  std::ranges::transform(views, seen.begin(), [](float v) { return std::uint8_t(v != 0); });
  return seen;
}

/// Indices of the rows that are not 0.
template <class T>
std::vector<std::int64_t> rows_of(const std::vector<T>& member) {
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < member.size(); ++i)
    if (member[i] != T(0)) rows.push_back(std::int64_t(i));
  return rows;
}

constexpr std::size_t kMaxViews = 20;      // evenly spread over the scene's: more change little
constexpr std::size_t kViewsPerPhoto = 2;  // of them

using Rows = std::vector<std::uint8_t>;  // [N] 1: of the object

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

/// The photo of the view; empty if it cannot be read: finishing does without.
ImageF photo_or_none(const Scene& scene, std::size_t view) {
  try {
    return io::load_photo(scene, view);
  } catch (const Error&) {
    return {};
  }
}

struct ObjectViews {
  std::vector<finish::SupportView> views;
  finish::MaskLack lack;
};

std::vector<ObjectViews> views_of(Run& run, const Extractor& extractor, const Scene& scene,
                                  const std::vector<Rows>& objects) {
  const GaussianCloud& cloud = extractor.cloud();
  const SplatOptions splat = prepared_for(run.exec(), splat_options({}, cloud, scene), cloud);
  const std::vector<int> indices = indices_in(scene, extractor);
  const finish::ObjectLabels labels(cloud, objects);
  std::vector<ObjectViews> found(objects.size());
  const std::size_t count = std::min(scene.views.size(), kMaxViews);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t v = i * scene.views.size() / count;
    const Camera& camera = scene.views[v].camera;
    const RenderedView rendered = labels.render(run.exec(), splat, camera);
    const ViewMasks masks = training_masks(scene, v);
    const ImageF photo = i % kViewsPerPhoto == 0 && masks.available ? photo_or_none(scene, v) : ImageF();
    for (std::size_t k = 0; k < objects.size(); ++k) {
      const std::vector<finish::GivenMask> given = given_mask(masks, indices[k]);
      if (!given.empty() && !photo.data.empty()) found[k].lack.add(given, photo);
      found[k].views.emplace_back(finish::FinishModel{cloud, objects[k]}, camera,
                                  finish::RenderedObject{rendered, int(k)}, given);
    }
    run.monitor().progress(std::int64_t(i + 1), std::int64_t(count));
  }
  return found;
}

/// Clips the objects. Returns the model with their clipped Gaussians; takes those without support from `objects`.
GaussianCloud finished_model(Run& run, const Extractor& extractor, const Scene& scene, std::vector<Rows>& objects) {
  const auto timed = run.monitor().scope("finish");
  const std::vector<ObjectViews> in = views_of(run, extractor, scene, objects);
  GaussianCloud model = extractor.cloud();
  std::int64_t clipped = 0, dropped = 0;
  std::size_t finished = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (const int lack = in[k].lack.px(); lack > 0) {
      run.monitor().warn("the photos change most " + std::to_string(lack) + " px outside of the masks of " +
                         extractor.chosen()[k]->object + ": the masks are too small, so the object is not finished");
      continue;
    }
    finish::Finished found = finish::finish_object(
        run.exec(), {{extractor.cloud(), objects[k]}, in[k].views, splat_options({}, model, scene), run.seed()});
    scatter_rows(run.exec(), found.object, RowNumbers(objects[k]).row, model);
    objects[k] = std::move(found.keep);
    clipped += found.clipped;
    dropped += found.dropped;
    ++finished;
  }
  run.result()["finish"] = {{"clipped", clipped}, {"dropped", dropped}};
  if (finished > 0)
    run.text("finished the object: " + std::to_string(clipped) + " Gaussians clipped, " + std::to_string(dropped) +
             " left out\n");
  return model;
}

}  // namespace

void report_unseen_surface(Run& run, const Extractor& extractor, const Scene& scene) {
  const std::vector<std::uint8_t>& object = extractor.object();
  if (std::ranges::find(object, 1) == object.end()) return;
  std::vector<Camera> cameras;
  for (const SceneView& view : scene.views) cameras.push_back(view.camera);
  const UnseenSurface found = unseen_surface(run.exec(), run.monitor(), {extractor.cloud(), object, cameras});
  const orbit::Vec d = found.direction;
  run.result()["unseen_surface"] = {{"share", found.share}, {"worst", found.worst}, {"worst_from", {d.x, d.y, d.z}}};
  if (found.share < kWorthTelling) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the object: no view sees %.0f %% of its outer surface; from the direction (%.2f, %.2f, %.2f) %.0f %%\n",
      100 * found.share, d.x, d.y, d.z, 100 * found.worst);
  run.text(text);
}

NumpyLabels::NumpyLabels(const Extractor& extractor) {
  for (const io::NamedLabels* object : extractor.chosen()) labels_.push_back(object->columns.label.values());
}

void NumpyLabels::write(const std::string& path, const Extractor& extractor) const {
  const std::vector<const io::NamedLabels*> objects = extractor.chosen();
  std::vector<float> labels(extractor.object().size());
  std::vector<std::uint8_t> seen(labels.size());
  std::vector<io::ZipEntry> single;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const LabelColumns& columns = objects[k]->columns;
    const std::vector<std::uint8_t> seen_here = seen_of(columns.views);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      labels[i] = std::max(labels[i], labels_[k][i]);
      seen[i] |= seen_here[i];
    }
    if (objects.size() == 1) continue;
    const std::string ending = "_" + objects[k]->object + ".npy";
    single.push_back({"labels" + ending, io::npy_of(labels_[k])});
    single.push_back({"seen" + ending, io::npy_of_flags(seen_here)});
    single.push_back({"object" + ending, io::npy_of(rows_of(columns.label.values()))});
  }
  std::vector<io::ZipEntry> entries{{"labels.npy", io::npy_of(labels)},
                                    {"seen.npy", io::npy_of_flags(seen)},
                                    {"object.npy", io::npy_of(rows_of(extractor.object()))}};
  std::ranges::move(single, std::back_inserter(entries));
  const std::vector<std::uint8_t> bytes = io::zip(entries);
  io::write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void write_objects(Run& run, const Extractor& extractor, const Scene* scene, const Outputs& out) {
  if (!out.object && !out.objects) return;
  std::vector<Rows> objects = objects_of(extractor);
  GaussianCloud finished;
  if (scene != nullptr) finished = finished_model(run, extractor, *scene, objects);
  const GaussianCloud* edited = scene != nullptr ? &finished : nullptr;
  Rows any(extractor.object().size());
  for (std::size_t k = 0; k < objects.size(); ++k) {
    for (std::size_t i = 0; i < any.size(); ++i) any[i] |= objects[k][i];
    if (!out.objects || objects.size() < 2) continue;
    std::filesystem::create_directories(out.objects.path);
    extractor.write(out.objects.path + "/" + extractor.chosen()[k]->object + ".ply", objects[k], edited);
  }
  if (scene != nullptr) run.result()["finish"]["object"] = std::ranges::count(any, std::uint8_t(1));
  if (out.object) extractor.write(out.object.path, any, edited);
}

}  // namespace ngs::cli
