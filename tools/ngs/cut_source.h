#pragma once
// The kinds of input of ngs cut: a splat without photos, a capture, or a scene.json.
#include <string>

namespace ngs::front {

enum class SourceKind { kSplat, kCapture, kScene };

/// Detects the kind: a folder, transforms.json, cameras.json or poses_bounds.npy is a capture, a JSON file with
/// "ngs_scene" a scene, everything else a splat, whose reader reports errors. Throws kBadInput if the path does not
/// exist.
SourceKind kind_of(const std::string& path);

/// False for an empty path and for one that cannot be read.
bool exists(const std::string& path);

/// Throws kBadInput, with a list of the files found, if the capture has no splat.
void require_model_in(const std::string& path);

}  // namespace ngs::front
