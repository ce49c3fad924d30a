#pragma once
// transforms.json of Blender, instant-ngp and nerfstudio. Poses are camera -> world with OpenGL axes (x right, y up,
// z backward).
//
// clang-format off
//   intrinsics         fl_x, fl_y (default: fl_x) or camera_angle_x [rad]; cx, cy (default: image centre); w, h
//                      (default: size of the image file; without the file, of the other images if all have one
//                      size, else the frame is left out). Each per file or per frame.
//   images             file_path, relative to the JSON file or absolute, with slashes or backslashes. Without an
//                      extension .png .jpg .jpeg are tried. A frame's name is its path without the folders that all
//                      frames share.
//   masks              mask_path per frame
//   distortion         k1..k4 of r^2, r^4, r^6, r^8, or of powers of the angle if camera_model is OPENCV_FISHEYE or
//                      is_fisheye is true; p1 p2 tangential; with FULL_OPENCV k4..k6 are the divisor. Read with
//                      Distortion::kKept; else a parameter of 1e-9 or more, or a fisheye model, is kBadInput.
//                      Panoramas are always kBadInput.
//   applied_transform  [3x4], with applied_scale: file world = scale · (transform of the original world). By default
//                      poses stay in the file's world. `original_world` undoes the transform, for a model that was
//                      trained on the COLMAP poses from which the file was made.
// clang-format on
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

Capture read_transforms_json(const std::string& path, bool original_world = false,
                             Distortion distortion = Distortion::kRefused);

struct TransformsSource {
  std::string folder;  // of the JSON file
  std::string object;  // its name in messages
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
/// Reads {"transform": 3x4, "scale": S}, nerfstudio's dataparser_transforms.json: from the world of the camera file to
/// the world of the exported model.
WorldTransform read_world_transform(const std::string& path);
void apply(const WorldTransform& world, Camera& camera);

// cameras.json, which 3DGS trainers write next to the model: a list of {id, img_name, width, height, position,
// rotation, fx, fy}. position = camera centre, rotation = camera -> world; x right, y down, z forward. The format has
// no principal point: without the extra keys cx and cy the image centre is assumed, with a note. img_name often has no
// file extension.

Capture read_cameras_json(const std::string& path);
Capture parse_cameras_json(const nlohmann::json& root, const std::string& object);

}  // namespace ngs::io
