#pragma once
// transforms.json of Blender, instant-ngp and nerfstudio. Poses are camera -> world with OpenGL axes (x
// right, y up, z backward).
//
//   intrinsics  fl_x, fl_y (default fl_x), cx, cy (default: centre), w, h, or camera_angle_x [rad]; per file
//   or
//               per frame. Without w and h the image itself is asked.
//   images      file_path, relative to the json file or absolute, with slashes or backslashes; without extension .png
//               .jpg .jpeg are tried. A frame's name is its path without the folders that all frames share.
//   masks       mask_path per frame
//   distortion  any k1..k6 p1 p2 of 1e-9 or more and fisheye models where distortion is asked for, else kBadInput:
//   k1..k4
//               of r^2, r^4, r^6, r^8, of the angle where the camera_model or is_fisheye says so; with FULL_OPENCV
//               k4..k6 divide. Panorama models: kBadInput
//   applied_transform [3x4], applied_scale: the world of the file = scale · (transform of the original
//               world). Kept by default, because that is the world the file's poses are in; `original_world`
//               undoes it, for a model trained on the COLMAP poses that the file was made from.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

Capture read_transforms_json(const std::string& path, bool original_world = false,
                             Distortion distortion = Distortion::kRefused);

struct TransformsSource {
  std::string folder;  // of the json file
  std::string object;  // names it in messages
  bool original_world = false;
  ImageFinder images;
  Distortion distortion = Distortion::kRefused;
};
Capture parse_transforms_json(const nlohmann::json& root, const TransformsSource& source);

/// A similarity of the world: x' = scale · (rotation x + translation).
struct WorldTransform {
  Mat3<double> rotation{{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  Vec3<double> translation{0, 0, 0};
  double scale = 1;
};
/// {"transform": 3x4, "scale": S}: nerfstudio's dataparser_transforms.json, from the world of the cameras'
/// file to the world of the exported model.
WorldTransform read_world_transform(const std::string& path);
/// The same camera in the new world.
void apply(const WorldTransform& world, Camera& camera);

}  // namespace ngs::io
