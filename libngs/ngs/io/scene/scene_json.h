#pragma once
// scene.json, the canonical description of a capture (scene/scene.h). Written by ngs-scene, read by every
// tool.
//
//   {"ngs_scene": 1, "model": PATH, "truth": PATH (optional: a folder of true masks),
//    "image_scale": S, "filter_px2": V (optional, default 0.3),
//    "compat": "inria"|"gsplat" (optional, default inria), "antialiased": BOOL (optional: as the PLY's comments say),
//    "background": [R, G, B] (optional: none where photos do not tell it), each in [0, 1],
//    "renders": {"note": "renders of the model, no photos", "coverage": SHARE} (optional: the photos are photos),
//    "masks": {"mode": "binary"|"label"|"soft"|"bands", "invert": BOOL, "threshold": 0..255,
//              "missing": "unknown"|"empty"|"error"},
//    "objects": [{"name": TEXT, "id": INT}],
//    "views": [{"name": TEXT, "width": PX, "height": PX, "fx": PX, "fy": PX, "cx": PX, "cy": PX,
//               "rotation": [9 numbers, world -> camera, row-major], "translation": [3 numbers],
//               "image": PATH, "mask": PATH, "split": "train"|"held-out"}]}
//
// Paths are relative to the folder of the json file, or to the working directory if it comes through a pipe (absolute
// ones and ".." are accepted: photos often lie beside the scene); in memory they are relative to the working directory.
// "image" and "mask" may be absent, "model" may be empty (before ngs-fit); "{object}" in "mask" stands for each
// object's name. Numbers keep all bits. Unknown keys, another version, non-finite numbers, rotations that are no
// rotations and repeated names are kBadInput. Files that the scene names are not opened here.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/io/files/relative_path.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

inline constexpr int kSceneVersion = 1;

Scene read_scene_json(const std::string& path);
/// The folder of true masks that the file records, relative to the working directory; empty: none. It is no part of
/// Scene, so that no stage can read it.
std::string truth_of_scene_json(const std::string& path);
/// Refuses (kBadInput) what read_scene_json would refuse. Appears by rename. `truth_dir`: truth_of_scene_json() of it.
void write_scene_json(const std::string& path, const Scene& scene, StoredPaths stored = StoredPaths::kRelative,
                      const std::string& truth_dir = {});

/// The same without files: `folder` is what relative paths start from, `object` names the text in messages.
Scene parse_scene_json(const nlohmann::json& json, const std::string& folder, const std::string& object);

/// What both check; also for scenes that were built in memory.
void validate_scene(const Scene& scene, const std::string& object);

}  // namespace ngs::io
