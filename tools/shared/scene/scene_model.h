#pragma once
// What the tools ask of a scene: its model, and that its photos stay.
#include <string>
#include <vector>

#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// A scene.json. Where its photos are renders of the model, "result" of the report says so.
Scene read_scene(Run& run, const std::string& path);

/// The scene's model becomes an input of the run. kBadInput where the scene names none, or no regular file.
void require_model(Run& run, const Scene& scene, const std::string& scene_path);

/// kUsage where one of the files that a run will write is a photo of the scene, which it would replace.
void refuse_over_photos(const Scene& scene, const std::vector<std::string>& files);

}  // namespace ngs::cli
