#include "dataset.h"

#include <algorithm>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/capture/sparse_points.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/make/synth/synth_halves.h"
#include "ngs/ops/image/image_bytes.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kHiddenTarget = 128;  // in masks of the target alone: other things hide it in the photo

io::ExrImage layers_of(const synth::SynthView& view) {
  io::ExrImage exr;
  exr.width_px = view.label.width_px;
  exr.height_px = view.label.height_px;
  exr.channels["Z"] = view.depth.data;
  exr.channels["ngs.mask"] = view.coverage.data;
  exr.channels["ngs.id"] = {view.label.data.begin(), view.label.data.end()};
  exr.text["ngs:schema"] = "ngs-synth layers 1";
  return exr;
}

Scene empty_scene(const SynthData& data) {
  Scene scene;
  scene.objects = {{data.scene.objects[std::size_t(data.scene.target)].name, 0}};
  scene.background = Vec3<double>{0, 0, 0};
  return scene;
}

/// The view's colours before they were composited over black, with its alpha.
ImageU8 cut_out(const synth::SynthView& view) {
  ImageF rgba(view.colour.width_px, view.colour.height_px, 4);
  for (std::size_t i = 0; i < view.coverage.data.size(); ++i) {
    const float alpha = view.coverage.data[i];
    for (std::size_t c = 0; alpha > 0 && c < 3; ++c) rgba.data[4 * i + c] = view.colour.data[3 * i + c] / alpha;
    rgba.data[4 * i + 3] = alpha;
  }
  return to_bytes(rgba);
}

void write_background_view(const std::string& folder, const std::string& name, const synth::SynthView& view,
                           const ImageU8& hole) {
  io::write_png(in_folder(folder + "/images", name), to_bytes(view.colour));
  io::write_png(in_folder(folder + "/masks", name), hole);
  io::ExrImage depth;
  depth.width_px = view.depth.width_px;
  depth.height_px = view.depth.height_px;
  depth.channels["Z"] = view.depth.data;
  io::write_exr(in_folder(folder + "/depth", fs::path(name).stem().string() + ".exr"), depth);
}

void write_background(Run& run, const std::string& folder, const SynthData& data) {
  const synth::AnalyticScene room = synth::without_target(data.scene);
  std::vector<Camera> cameras = data.cameras;
  cameras.insert(cameras.end(), data.hole_cameras.begin(), data.hole_cameras.end());
  Scene scene = empty_scene(data);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (run.stop_code() != 0) return;
    const bool is_photo = i < data.views.size();
    const ImageU16 label =
        is_photo ? data.views[i].label : synth::render_view(run.exec(), data.scene, cameras[i], 1).label;
    const synth::SynthView view = synth::render_view(run.exec(), room, cameras[i], data.recipe.samples_per_side);
    write_background_view(folder, cameras[i].name, view, binary_mask(label, std::uint32_t(data.scene.target) + 1));
    scene.views.push_back({cameras[i], folder + "/images/" + cameras[i].name, folder + "/masks/" + cameras[i].name,
                           is_photo ? Split::kTrain : Split::kHeldOut});
  }
  io::write_scene_json(folder + "/scene.json", scene);
}

void write_object(Run& run, const std::string& folder, const SynthData& data) {
  const synth::AnalyticScene target = synth::target_alone(data.scene);
  Scene scene = empty_scene(data);
  scene.mask_mode = MaskMode::kSoft;
  for (const Camera& camera : synth::target_rig(data.recipe, data.scene)) {
    if (run.stop_code() != 0) return;
    const std::string path = in_folder(folder + "/images", camera.name);
    io::write_png(path, cut_out(synth::render_view(run.exec(), target, camera, data.recipe.samples_per_side)));
    scene.views.push_back({camera, path, path, Split::kHeldOut});
  }
  io::write_scene_json(folder + "/scene.json", scene);
  for (std::size_t i = 0; i < data.cameras.size(); ++i) {
    if (run.stop_code() != 0) return;
    const Camera& camera = data.cameras[i];
    const auto id = std::uint32_t(data.scene.target) + 1;
    ImageU8 mask = binary_mask(data.views[i].label, id);
    const ImageU8 whole = binary_mask(synth::render_view(run.exec(), target, camera, 1).label, id);
    for (std::size_t p = 0; p < mask.data.size(); ++p)
      if (whole.data[p] > mask.data[p]) mask.data[p] = kHiddenTarget;
    io::write_png(in_folder(folder + "/masks", camera.name), mask);
  }
}

}  // namespace

FitOptions small_fit() {
  FitOptions options;
  options.steps = 1500;
  options.sh_degree = 1;
  options.max_gaussians = 8000;
  options.near_loss = 0;  // initial points are on the surfaces, and measured tables refer to these splats
  return options;
}

void make_finer(FitOptions& options, const synth::Recipe& recipe) {
  if (options.max_gaussians == small_fit().max_gaussians) options.max_gaussians = 20000 + 200 * recipe.objects;
  if (options.steps == small_fit().steps) options.steps = 800;
}

void fit_splat(Run& run, const SynthData& data, const FitOptions& options, const std::string& path) {
  const std::vector<FitView> views = fit_views(data);
  Fitter fitter(options, views, initial_fit(run.exec(), options, fit_points(data.points), views, run.seed()),
                run.seed());
  const double start = wall_seconds();
  run_fit(run.exec(), run.monitor(), fitter, options, {});
  const double seconds = wall_seconds() - start;
  if (run.stop_code() != 0) return;
  const GaussianCloud& cloud = fitter.state().cloud;
  const FitScore score = score_fit(run.exec(), options, cloud, views, Split::kTrain);
  const std::string history = io::history_line("ngs-synth", recipe_json(data.recipe).dump());
  io::write_strict_ply(path, cloud, {}, io::trained_comments(history, options.antialiased));
  run.result()["gaussians"] = cloud.size();
  run.result()["fit"] = {{"steps", options.steps},
                         {"max_gaussians", options.max_gaussians},
                         {"steps_per_s", options.steps / seconds},
                         {"psnr_db", score.psnr_db},
                         {"ssim", score.ssim}};
}

void build(SynthData& data, bool with_halves) {
  data.scene = synth::build_scene(data.recipe);
  data.cameras = synth::build_rig(data.recipe, data.scene);
  if (with_halves) data.hole_cameras = synth::hole_rig(data.recipe, data.scene);
}

std::string in_folder(const std::string& folder, const std::string& name) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ErrorCode::kEnvironment, folder + ": " + error.message() + ", expected a folder to write to");
  return folder + "/" + name;
}

ImageU8 binary_mask(const ImageU16& labels, std::uint32_t id) {
  ImageU8 mask(labels.width_px, labels.height_px, 1);
  for (std::size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = labels.data[i] == id ? 255 : 0;
  return mask;
}

void write_view(const Exec& exec, const std::string& folder, const SynthData& data, std::size_t view,
                const MaskErrors& errors) {
  const synth::SynthView& v = data.views[view];
  const std::string& name = data.cameras[view].name;
  const auto target = std::uint32_t(data.scene.target) + 1;
  const auto write_mask = [&](const std::string& kind, const ImageU8& mask) {
    io::write_png(in_folder(folder + "/" + kind, name), mask);
  };
  io::write_png(in_folder(folder + "/images", name), to_bytes(v.colour));
  write_mask("masks_gt", binary_mask(v.label, target));
  io::write_png16(in_folder(folder + "/labels_gt", name), v.label);
  const bool is_messy = data.recipe.scene == synth::SceneKind::kMessy;  // a file per object and view: too many
  for (std::size_t k = 0; !is_messy && k < data.scene.objects.size(); ++k)
    write_mask("objects/" + data.scene.objects[k].name, binary_mask(v.label, std::uint32_t(k) + 1));
  const auto disturbed = [&](std::uint32_t only_id) {
    return synth::disturb_labels(exec, v.label, errors.noise, {only_id, int(view), errors.seed, &v.colour});
  };
  write_mask("masks", binary_mask(disturbed(target), 1));
  io::write_png16(in_folder(folder + "/labels", name), disturbed(0));
  if (errors.everything)
    io::write_png16(
        in_folder(folder + "/masks_everything", name),
        synth::masks_of_everything(exec, v.label, errors.noise, {0, int(view), errors.seed, &v.colour, &v.surface}));
  io::write_exr(in_folder(folder + "/layers", fs::path(name).stem().string() + ".exr"), layers_of(v));
}

void write_description(const std::string& folder, const SynthData& data, const MaskErrors& errors) {
  io::write_colmap_text(folder + "/sparse/0", data.cameras, data.points);
  io::write_file(folder + "/recipe.json", recipe_json(data.recipe).dump(2) + "\n");
  Json truth = {{"target", data.scene.objects[std::size_t(data.scene.target)].name}, {"objects", Json::array()}};
  for (std::size_t k = 0; k < synth::object_count(data.scene); ++k)
    truth["objects"].push_back({{"name", data.scene.objects[k].name}, {"id", k + 1}});
  truth["mask_noise"] = errors.specs;
  truth["seed"] = errors.seed;
  io::write_file(folder + "/ground_truth.json", truth.dump(2) + "\n");
}

synth::Recipe load_recipe(const std::string& name_or_path, bool& is_file) {
  const std::vector<std::string> names = synth::recipe_names();
  is_file = std::find(names.begin(), names.end(), name_or_path) == names.end() && fs::is_regular_file(name_or_path);
  if (!is_file) return synth::named_recipe(name_or_path);
  synth::Recipe recipe;
  OptionSet options;
  options.add(recipe);
  const io::MappedFile file(name_or_path);
  options.set_json(parse_json(file.text(), name_or_path), name_or_path);
  return recipe;
}

Json recipe_json(const synth::Recipe& recipe) {
  synth::Recipe copy = recipe;
  OptionSet options;
  options.add(copy);
  Json json = options.to_json();
  if (!recipe.cast_shadows) json.erase("cast_shadows");  // recipes without one keep their bytes
  if (recipe.scene != synth::SceneKind::kMessy) json.erase("objects");
  return json;
}

std::vector<FitView> fit_views(const SynthData& data) {
  std::vector<FitView> views;
  for (std::size_t i = 0; i < data.views.size(); ++i) {
    ImageF photo = data.views[i].colour;
    const ImageU8 bytes = to_bytes(photo);
    for (std::size_t k = 0; k < bytes.data.size(); ++k) photo.data[k] = float(bytes.data[k]) / 255.f;
    views.push_back({data.cameras[i], std::move(photo), Split::kTrain});
  }
  return views;
}

std::vector<FitPoint> fit_points(const std::vector<SparsePoint>& points) {
  std::vector<FitPoint> out;
  for (const SparsePoint& p : points)
    out.push_back({{float(p.position.x), float(p.position.y), float(p.position.z)},
                   {float(p.rgb[0]) / 255.f, float(p.rgb[1]) / 255.f, float(p.rgb[2]) / 255.f}});
  return out;
}

std::size_t views_of_halves(const SynthData& data) {
  if (data.hole_cameras.empty()) return 0;
  return data.cameras.size() + data.hole_cameras.size() + synth::kTargetViews;
}

void write_halves(Run& run, const std::string& folder, const SynthData& data) {
  const auto timed = run.monitor().scope("halves");
  write_background(run, folder + "/background", data);
  write_object(run, folder + "/object", data);
}

}  // namespace ngs::cli
