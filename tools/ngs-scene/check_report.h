#pragma once
// Results of scene_check.h as JSON for the report, and as a text table.
#include "ngs/capture/scene_check.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/options/option_set.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::scene_tool {

/// Sources that import found: files, folders and format.
Json import_json(const io::ImportedScene& imported);

Json check_json(const Scene& scene, const SceneCheck& check);
Json health_json(const CloudHealth& health);
std::string check_table(const Scene& scene, const SceneCheck& check);

}  // namespace ngs::scene_tool
