#include <algorithm>
#include <filesystem>

#include "evaluation.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/scene/view_names.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

/// Whether every file is in a folder with the name of an object.
bool has_folders_of_objects(const ImageList& list, const std::vector<SceneObject>& objects) {
  return std::ranges::all_of(list.names, [&](const std::string& name) {
    return std::ranges::any_of(objects, [&](const SceneObject& o) { return name.starts_with(o.name + "/"); });
  });
}

}  // namespace

bool is_scene_file(const std::string& path) { return fs::path(path).extension() == ".json"; }

SceneMasks::SceneMasks(const std::string& path)
    : scene_(io::read_scene_json(path)), truth_dir_(io::truth_of_scene_json(path)) {
  for (std::size_t v = 0; v < scene_.views.size(); ++v)
    if (scene_.views[v].split == Split::kHeldOut) views_.push_back(v);
  held_out_ = !views_.empty();
  for (std::size_t v = 0; !held_out_ && v < scene_.views.size(); ++v) views_.push_back(v);
}

std::string SceneMasks::problem() const {
  if (!truth_dir_.empty()) return {};
  if (!held_out_) return "no true masks are known, and no view is held out";
  const auto has_mask = [&](std::size_t v) { return !scene_.views[v].mask_path.empty(); };
  if (std::ranges::none_of(views_, has_mask)) return "no true masks are known, and no held-out view has an input mask";
  if (scene_.mask_invert) return "no true masks are known, and the input masks are inverted";
  if (scene_.mask_mode == MaskMode::kBands) return "no true masks are known, and the input masks are bands";
  return {};
}

std::string SceneMasks::problem_of_inputs(const EvalOptions& options) const {
  if (inputs_are_truth()) return "the input masks are the truth";
  if (scene_.mask_invert) return "the input masks are inverted";
  if (scene_.mask_mode == MaskMode::kBands) return "the input masks are bands";
  if ((scene_.mask_mode == MaskMode::kLabel) != options.label_map)
    return options.label_map ? "the true masks are label maps, the input masks are not"
                             : "the input masks are label maps, the true masks are not (if they are: --label-map)";
  return input_masks().names.empty() ? "no scored view has an input mask" : "";
}

ImageList SceneMasks::truth() const { return inputs_are_truth() ? input_masks() : list_images(truth_dir_); }

ImageList SceneMasks::input_masks() const {
  const std::vector<std::string> names = output_names(scene_.views);
  std::vector<std::pair<std::string, std::string>> found;  // name, file
  for (const std::size_t v : views_) {
    const std::vector<std::string> files = io::mask_files(scene_, v);
    const bool per_object = scene_.objects.size() > 1 && scene_.mask_mode != MaskMode::kLabel;
    for (std::size_t k = 0; k < files.size(); ++k)
      if (fs::is_regular_file(files[k]))
        found.emplace_back((per_object ? scene_.objects[k].name + "/" : "") + names[v] + ".png", files[k]);
  }
  std::ranges::sort(found);
  ImageList list{"the input masks", {}, {}};
  for (auto& [name, file] : found) {
    list.names.push_back(std::move(name));
    list.files.push_back(std::move(file));
  }
  return list;
}

void SceneMasks::complete(EvalOptions& options, EvalFileOptions& files) const {
  const bool label_maps = scene_.mask_mode == MaskMode::kLabel;
  if (label_maps && inputs_are_truth()) options.label_map = true;
  if (label_maps && options.label_map) {
    if (options.object_id.empty())
      for (const SceneObject& object : scene_.objects)
        options.object_id.push_back(object.name + "=" + std::to_string(object.id));
    if (options.void_id < 0 && scene_.void_id) options.void_id = int(*scene_.void_id);
  }
  const bool of_objects = scene_.objects.size() > 1 && has_folders_of_objects(truth(), scene_.objects);
  files.layout = of_objects ? Layout::kObjectView : Layout::kView;
  if (files.views != "all") return;
  const std::vector<std::string> names = output_names(scene_.views);
  for (const std::size_t v : views_) {
    if (!of_objects) files.scene_views.push_back(names[v] + ".png");
    for (std::size_t k = 0; of_objects && k < scene_.objects.size(); ++k)
      files.scene_views.push_back(scene_.objects[k].name + "/" + names[v] + ".png");
  }
}

std::optional<Masks> masks_of_scene(Run& run, const std::string& predicted, const std::string& scene_json,
                                    EvalOptions& options, EvalFileOptions& files) {
  const SceneMasks scene(scene_json);
  const bool scores_inputs = is_scene_file(predicted);
  std::string problem = scene.problem();
  if (problem.empty()) {
    scene.complete(options, files);
    if (scores_inputs) problem = scene.problem_of_inputs(options);
  }
  if (!problem.empty()) {
    run.nothing_found(
        "nothing is scored: " + problem,
        "record true masks in the scene, or hold views out: ngs-scene import --truth DIR --hold-out RULE");
    return {};
  }
  if (scene.inputs_are_truth())
    run.text("no true masks are known: scored against the input masks of the held-out views\n");
  return Masks{scores_inputs ? scene.input_masks() : list_images(predicted), scene.truth()};
}

}  // namespace ngs::cli
