#pragma once
// scene.json, the canonical description of a capture (scene/scene.h). Written by ngs-scene, read by all tools.
//
//   {"ngs_scene": 1, "model": PATH, "truth": PATH (optional: a folder of true masks),
//    "image_scale": S, "filter_px2": V (optional, default 0.3),
//    "compat": "inria"|"gsplat" (optional, default inria), "antialiased": BOOL (optional, default: the PLY's comments),
//    "world_unit": U (optional, default 1; below 1 in small worlds: near planes shrink with it),
//    "background": [R, G, B] (optional: absent if the photos do not determine it), each in [0, 1],
//    "renders": {"note": "renders of the model, no photos", "coverage": SHARE} (optional, absent for photos),
//    "masks": {"mode": "binary"|"label"|"soft"|"bands", "invert": BOOL, "threshold": 0..255,
//              "missing": "unknown"|"empty"|"error"},
//    "objects": [{"name": TEXT, "id": INT}],
//    "views": [{"name": TEXT, "width": PX, "height": PX, "fx": PX, "fy": PX, "cx": PX, "cy": PX,
//               "rotation": [9 numbers, world -> camera, row-major], "translation": [3 numbers],
//               "image": PATH, "mask": PATH, "split": "train"|"held-out"}]}
//
// Paths are relative to the folder of the JSON file, or to the working directory if it is read from a pipe. Absolute
// paths and ".." are accepted: photos are often outside the scene's folder. In memory paths are relative to the working
// directory. "image" and "mask" may be absent, "model" may be empty (before ngs-fit); "{object}" in "mask" is replaced
// by each object's name. Numbers round-trip exactly. Unknown keys, another version, non-finite numbers, matrices that
// are not rotations and repeated names are kBadInput. Files named in the scene are not opened here.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/io/files/relative_path.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

inline constexpr int kSceneVersion = 1;

Scene read_scene_json(const std::string& path);
/// The folder of true masks in the file, relative to the working directory; empty: none. It is not a member of Scene,
/// so that no stage can read it.
std::string truth_of_scene_json(const std::string& path);
/// Atomic. kBadInput for what read_scene_json() would reject. `truth_dir`: as returned by truth_of_scene_json().
void write_scene_json(const std::string& path, const Scene& scene, StoredPaths stored = StoredPaths::kRelative,
                      const std::string& truth_dir = {});

/// The same without files: relative paths start from `folder`; `object` is the name in messages.
Scene parse_scene_json(const nlohmann::json& json, const std::string& folder, const std::string& object);

/// The checks of both; also for scenes built in memory.
void validate_scene(const Scene& scene, const std::string& object);

}  // namespace ngs::io
