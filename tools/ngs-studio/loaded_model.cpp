#include "loaded_model.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include "ngs/core/error.h"
#include "ngs/io/files/shell_word.h"
#include "ngs/io/scene/scene_json.h"
#include "ngs/math/vectors.h"
#include "ngs/render/render_options.h"

namespace ngs::studio {

live::Viewpoint viewpoint_of_view(const Camera& camera, double distance) {
  const Mat3<double>& r = camera.rotation;
  const Vec3<double> at = camera.centre(), down{r(1, 0), r(1, 1), r(1, 2)}, forward{r(2, 0), r(2, 1), r(2, 2)};
  const double fov_y_deg = 360 / std::numbers::pi * std::atan(0.5 * camera.height_px / camera.fy);
  return {at, at + distance * forward, -1.0 * down, fov_y_deg, camera.width_px, camera.height_px};
}

LoadedModel::LoadedModel(const Exec& exec, const std::string& source) {
  if (std::filesystem::is_directory(source))
    throw Error(ErrorCode::kBadInput, source + ": a folder, expected a splat or a scene.json",
                "open the splat in it; of a capture: ngs-scene import " + io::shell_word(source) +
                    " -o scene.json, then ngs-studio scene.json");
  is_scene = std::filesystem::path(source).extension() == ".json";
  if (is_scene) {
    scene = io::read_scene_json(source);
    if (scene.model_path.empty())
      throw Error(ErrorCode::kBadInput, source + ": names no model, expected a 3DGS model",
                  "import the scene again with --ply MODEL.ply");
  } else {
    scene.model_path = source;
    scene.objects = {SceneObject{}};
  }
  ply = io::read_gaussian_ply(scene.model_path);
  first = with_context(scene.model_path, [&] { return live::initial_viewpoint(exec, ply.cloud); });
  if (!is_scene) scene.world_unit = first.world_unit;
  splat = prepared_for(exec, splat_options({}, ply.cloud, scene), ply.cloud);
  if (is_scene && !scene.views.empty()) {
    const Camera& camera = scene.views.front().camera;
    const Vec3<double> line = first.centre - camera.centre();
    first.viewpoint = viewpoint_of_view(camera, std::max(0.1 * first.radius, length(line)));
    first.up = first.viewpoint.up;
  }
}

RefinedModel::RefinedModel(const Exec& exec, const std::string& labelled, const LoadedModel& of,
                           const live::ObjectMarks& marks)
    : ply(io::read_gaussian_ply(labelled)), splat(of.splat) {
  splat.prepared = nullptr;
  splat = prepared_for(exec, splat, ply.cloud);
  live::ObjectLabels labels;
  labels.label = ply.labels.label.values();
  labels.boundary.resize(labels.label.size());
  for (std::size_t i = 0; i < labels.label.size(); ++i) {
    labels.label[i] = float(labels.label[i] >= 0.5f);
    labels.count += labels.label[i] > 0;
    labels.boundary[i] = i < ply.labels.boundary.size() && ply.labels.boundary[i] > 0;
  }
  found = live::restore_under_strokes(exec, {ply.cloud, splat, background_of(of.scene)}, labels, marks);
}

}  // namespace ngs::studio
