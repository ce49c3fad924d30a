#pragma once
// What ngs-variance and ngs-mask ask of a scene: its model.
#include <string>

#include "ngs/scene/scene.h"
#include "shared/tool.h"

namespace ngs::cli {

/// The scene's model becomes an input of the run. kBadInput where the scene names none.
void require_model(Run& run, const Scene& scene, const std::string& scene_path);

}  // namespace ngs::cli
