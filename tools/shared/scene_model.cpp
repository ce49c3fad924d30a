#include "shared/scene_model.h"

#include "ngs/core/error.h"

namespace ngs::cli {

void require_model(Run& run, const Scene& scene, const std::string& scene_path) {
  if (scene.model_path.empty())
    throw Error(ErrorCode::kBadInput, scene_path + ": names no model, expected a 3DGS PLY",
                "import the scene again with --ply MODEL.ply, or fit one: ngs-fit " + scene_path + " -o model.ply");
  run.add_input("model", scene.model_path);
}

}  // namespace ngs::cli
