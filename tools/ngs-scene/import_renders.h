#pragma once
// ngs-scene import of what ngs-scene orbit wrote: masks are attached, renders tell nothing about their model.
#include "ngs/io/scene/import_scene.h"
#include "ngs/stages/scene/scene_check.h"
#include "shared/run/run.h"

namespace ngs::capture {

/// Checks the scene. The model stays what the renders were drawn with: no filter, background or alignment is looked
/// for, and options of these are warned about.
void check_renders(cli::Run& run, const SceneCheckOptions& checks, io::ImportedScene& imported);

}  // namespace ngs::capture
