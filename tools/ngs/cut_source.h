#pragma once
// What ngs cut is given: a splat alone, a capture, or a scene.json.
#include <string>

namespace ngs::front {

enum class SourceKind { kSplat, kCapture, kScene };

/// By what is at the path: a folder, transforms.json, cameras.json or poses_bounds.npy is a capture, a JSON file with
/// "ngs_scene" a scene, everything else a splat, whose reader says what is wrong with it. kBadInput for nothing there.
SourceKind kind_of(const std::string& path);

/// kBadInput, with the files that are there and what they are, where ngs-scene import will find no splat in the
/// capture.
void require_model_in(const std::string& path);

}  // namespace ngs::front
