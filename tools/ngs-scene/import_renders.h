#pragma once
// ngs-scene import of a scene of ngs-scene orbit: attaches masks; renders give no information about the model.
#include "ngs/io/scene/import_scene.h"
#include "ngs/stages/scene/scene_check.h"
#include "shared/run/run.h"

namespace ngs::capture {

/// Checks the scene. Keeps the model settings of the renders: estimates no filter, background or alignment, and warns
/// if their options are given.
void check_renders(cli::Run& run, const SceneCheckOptions& checks, io::ImportedScene& imported);

}  // namespace ngs::capture
