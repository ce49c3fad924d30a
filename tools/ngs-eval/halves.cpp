#include <cstdio>
#include <filesystem>
#include <optional>

#include "evaluation.h"
#include "metrics_json.h"
#include "ngs/eval/halves_stage.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/image/masks.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/render/render_options.h"

namespace ngs::cli {
namespace {

namespace fs = std::filesystem;

/// A model, prepared for renders over black at the cameras of a scene.
class Renderer {
 public:
  Renderer(Run& run, const std::string& name, const std::string& path, const Scene& scene) : exec_(run.exec()) {
    run.add_input(name, path);
    ply_ = io::read_gaussian_ply(path);
    splat_ = prepared_for(exec_, splat_options({}, ply_.cloud, scene), ply_.cloud);
  }
  Renderer(const Renderer&) = delete;
  RenderedView view(const Camera& camera) const { return render(exec_, ply_.cloud, camera, splat_, RenderRequest{}); }

 private:
  const Exec& exec_;
  io::GaussianPly ply_;
  SplatOptions splat_;
};

ImageF depth_of(const std::string& folder, const Camera& camera) {
  const std::string path = folder + "/depth/" + fs::path(camera.name).stem().string() + ".exr";
  io::ExrImage exr = io::read_exr(path);
  const auto z = exr.channels.find("Z");
  if (z == exr.channels.end() || exr.width_px != camera.width_px || exr.height_px != camera.height_px)
    throw Error(ErrorCode::kBadInput,
                path + ": no channel 'Z' of the camera's size, expected the depth of ngs-synth --truth halves");
  ImageF depth(exr.width_px, exr.height_px, 1);
  depth.data = std::move(z->second);
  return depth;
}

std::vector<float> mask_of(const Scene& scene, std::size_t view) {
  ViewMasks masks = io::load_masks(scene, view);
  if (!masks.available || scene.views[view].image_path.empty())
    throw Error(ErrorCode::kBadInput, scene.views[view].camera.name + ": no photo or no mask, expected both",
                "write the truth again with ngs-synth --truth halves");
  return std::move(masks.target.front());
}

std::vector<Camera> cameras_of(const Scene& scene, std::optional<Split> split = {}) {
  std::vector<Camera> cameras;
  for (const SceneView& view : scene.views)
    if (!split || view.split == *split) cameras.push_back(view.camera);
  return cameras;
}

Json alone_json(const AloneScore& s) {
  return {{"iou", s.iou},
          {"biou", s.biou},
          {"psnr_db", s.psnr_db},
          {"spikes_px", s.spikes_px},
          {"longest_spike_px", s.longest_spike_px},
          {"holes_px", s.holes_px}};
}

/// "views" and the means; only "views" if there are none.
Json group_json(const std::vector<AloneScore>& scores) {
  Json json = {{"views", scores.size()}};
  if (!scores.empty()) json.update(alone_json(mean_of(scores)));
  return json;
}

Json object_json(Run& run, const std::string& path, const Scene& scene, const Scene& photographed) {
  const Renderer model(run, "object", path, scene);
  const std::vector<Camera> cameras = cameras_of(scene), photos = cameras_of(photographed, Split::kTrain);
  const std::optional<Vec3<double>> centre = point_nearest_to_axes(cameras);
  if (!centre)
    throw Error(ErrorCode::kBadInput,
                "cameras of the object alone: all look into one direction, expected all directions");
  std::vector<AloneScore> seen, unseen, all;
  Json views = Json::array();
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    ImageF alpha(cameras[v].width_px, cameras[v].height_px, 1);
    alpha.data = mask_of(scene, v);
    const AloneScore score = score_alone(run.exec(), model.view(cameras[v]), io::load_photo(scene, v), alpha);
    const double angle_deg = angle_to_nearest(*centre, cameras[v], photos);
    all.push_back(score);
    (angle_deg <= kSeenAngle_deg ? seen : unseen).push_back(score);
    views.push_back({{"view", cameras[v].name}, {"angle_deg", angle_deg}});
    views.back().update(alone_json(score));
  }
  return {{"seen", group_json(seen)}, {"unseen", group_json(unseen)}, {"all", group_json(all)}, {"views", views}};
}

/// Means over the views of a split whose hole is not empty.
Json holes_json(const std::vector<HoleScore>& scores) {
  Json json = {{"views", scores.size()}};
  double psnr_db = 0, ssim = 0;
  for (const HoleScore& s : scores) {
    psnr_db += s.psnr_db;
    ssim += s.ssim;
  }
  if (!scores.empty())
    json.update({{"psnr_db", psnr_db / double(scores.size())}, {"ssim", ssim / double(scores.size())}});
  return json;
}

HoleView hole_view(const Renderer& model, const Scene& scene, std::size_t v, const std::string& folder) {
  HoleView view{scene.views[v].camera, {}, io::load_photo(scene, v), depth_of(folder, scene.views[v].camera), {}};
  view.rendered = model.view(view.camera).colour;
  for (const float m : mask_of(scene, v)) view.hole.push_back(m >= 0.5f);
  return view;
}

Json background_json(Run& run, const std::string& path, const Scene& scene, const HalvesInput& input) {
  const Renderer model(run, "background", path, scene);
  std::vector<HoleView> views;
  std::vector<HoleScore> photos, fresh;
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    views.push_back(hole_view(model, scene, v, input.truth + "/background"));
    const std::vector<std::uint8_t>& hole = views.back().hole;
    if (std::find(hole.begin(), hole.end(), 1) == hole.end()) continue;
    (scene.views[v].split == Split::kTrain ? photos : fresh).push_back(score_hole(run.exec(), views.back()));
  }
  const Flicker change = flicker(run.exec(), views);
  Json json = {{"photos", holes_json(photos)},
               {"new", holes_json(fresh)},
               {"flicker", change.mean},
               {"flicker_points", change.points}};
  if (input.model.empty()) return json;
  const Renderer full(run, "model", input.model, scene);
  std::vector<ImageF> uncut;
  for (const HoleView& view : views) uncut.push_back(full.view(view.camera).colour);
  const OutsideChange outside = outside_change(views, uncut);
  json["outside_change"] = {{"mean", outside.mean}, {"most", outside.most}};
  return json;
}

std::string row_of(const std::string& name, const Json& values, std::initializer_list<const char*> keys) {
  char cell[64];
  std::snprintf(cell, sizeof cell, "%-18s%8d", name.c_str(), values.at("views").get<int>());
  std::string row = cell;
  for (const char* key : keys) {
    if (!values.contains(key)) continue;
    std::snprintf(cell, sizeof cell, "%13.4f", values.at(key).get<double>());
    row += cell;
  }
  return row + "\n";
}

std::string table_of(const Json& metrics) {
  std::string table;
  if (metrics.contains("object")) {
    table +=
        "object alone         views          IoU        B-IoU      PSNR dB    spikes px   longest px     holes px\n";
    for (const char* group : {"seen", "unseen", "all"})
      table += row_of(group, metrics["object"][group],
                      {"iou", "biou", "psnr_db", "spikes_px", "longest_spike_px", "holes_px"});
  }
  if (metrics.contains("background")) {
    const Json& background = metrics["background"];
    table += "hole                 views      PSNR dB         SSIM\n";
    for (const char* group : {"photos", "new"}) table += row_of(group, background[group], {"psnr_db", "ssim"});
    char line[160];
    std::snprintf(line, sizeof line, "flicker of %d points: %.4f\n", background["flicker_points"].get<int>(),
                  background["flicker"].get<double>());
    table += line;
    if (background.contains("outside_change")) {
      const Json& outside = background["outside_change"];
      std::snprintf(line, sizeof line, "change outside of the hole: mean %.5f, most %.4f\n",
                    outside["mean"].get<double>(), outside["most"].get<double>());
      table += line;
    }
  }
  return table;
}

/// FOLDER/NAME if it exists.
std::optional<std::string> file_in(const std::string& folder, const char* name) {
  const fs::path path = fs::path(folder) / name;
  return fs::is_regular_file(path) ? std::optional(path.generic_string()) : std::nullopt;
}

}  // namespace

void check_halves_options(Run& run, const EvalOptions& options, const EvalFileOptions& files) {
  if (!files.halves) return run.warn_unused({"--model"}, "without --halves");
  if (files.image_metrics || files.opacity || !options.fail_below.empty())
    throw Error(ErrorCode::kUsage,
                "--halves with --image-metrics, --opacity or --fail-below, expected it without them");
  run.warn_unused({"--threshold", "--label-map", "--void-id", "--object-id", "--views", "--layout", "--allow-missing"},
                  "with --halves");
}

void score_halves(Run& run, const HalvesInput& input) {
  const std::optional<std::string> object = file_in(input.cut, "object.ply"),
                                   background = file_in(input.cut, "background.ply");
  if (!object && !background)
    throw Error(
        ErrorCode::kBadInput, input.cut + ": neither object.ply nor background.ply, expected one of them",
        "cut the model: ngs-extract labelled.ply --object-ply DIR/object.ply --background-ply DIR/background.ply");
  const Scene room = io::read_scene_json(input.truth + "/background/scene.json"),
              alone = io::read_scene_json(input.truth + "/object/scene.json");
  if (run.dry_run()) return;
  const auto timed = run.monitor().scope("score halves");
  Json metrics = {{"ngs_metrics", kMetricsVersion}, {"kind", "halves"}};
  if (object) metrics["object"] = object_json(run, *object, alone, room);
  if (background) metrics["background"] = background_json(run, *background, room, input);
  io::write_file(input.output, metrics.dump(2) + "\n");
  for (const char* half : {"object", "background"})
    if (metrics.contains(half)) run.result()[half] = metrics[half];
  if (object) run.result()["object"].erase("views");
  run.text(table_of(metrics));
}

}  // namespace ngs::cli
