#include "shared/scene/scene_model.h"

#include <filesystem>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/scene/scene_json.h"

namespace ngs::cli {

Scene read_scene(Run& run, const std::string& path) {
  Scene scene = io::read_scene_json(path);
  if (scene.renders) run.result()["photos"] = kRenderedPhotosNote;
  return scene;
}

void require_model(Run& run, const Scene& scene, const std::string& scene_path) {
  if (scene.model_path.empty())
    throw Error(ErrorCode::kBadInput, scene_path + ": names no model, expected a 3DGS PLY",
                "import the scene again with --ply MODEL.ply, or fit one: ngs-fit " + scene_path + " -o model.ply");
  io::require_regular_file(scene.model_path);
  run.add_input("model", scene.model_path);
}

void refuse_over(const std::vector<std::string>& kept, const std::vector<std::string>& files, const std::string& why,
                 const std::string& remedy) {
  std::error_code ignored;
  std::set<std::filesystem::path> paths;
  for (const std::string& path : kept)
    if (!path.empty()) paths.insert(std::filesystem::weakly_canonical(path, ignored));
  for (const std::string& file : files)
    if (paths.contains(std::filesystem::weakly_canonical(file, ignored)))
      throw Error(ErrorCode::kUsage, file + why, remedy);
}

void refuse_over_photos(const Scene& scene, const std::vector<std::string>& files) {
  std::vector<std::string> photos;
  for (const SceneView& view : scene.views) photos.push_back(view.image_path);
  refuse_over(photos, files, ": is a photo of the scene, which this run would replace",
              "choose another folder for the output");
}

BoundarySet boundary_of(Run& run, const io::GaussianPly& ply, const std::string& path) {
  if (ply.cloud.size() == 0)
    run.nothing_found(path + ": the model has no Gaussians, expected some",
                      "use a model with Gaussians: ngs-variance scene.json -o boundary.ply");
  if (ply.labels.boundary.size() != std::size_t(ply.cloud.size()))
    throw Error(ErrorCode::kBadInput,
                path + ": vertex property 'ngs_boundary' is missing, expected a PLY written by ngs-variance",
                "find the boundary first: ngs-variance scene.json -o boundary.ply");
  BoundarySet set = boundary_set(ply.cloud, ply.labels.boundary.values());
  run.result()["boundary"] = set.size();
  if (set.size() == 0)
    run.nothing_found(path + ": no boundary Gaussians, expected at least one",
                      "lower the threshold: ngs-variance scene.json -o boundary.ply --tau 0.4");
  return set;
}

}  // namespace ngs::cli
