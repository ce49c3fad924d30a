#pragma once
// cameras.json, which 3DGS trainers write next to the model: a list of {id, img_name, width, height, position,
// rotation, fx, fy}. position = camera centre, rotation = camera -> world; x right, y down, z forward. The format has
// no principal point: without the extra keys cx and cy the image centre is assumed, with a note. img_name often has no
// file extension.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

Capture read_cameras_json(const std::string& path);
Capture parse_cameras_json(const nlohmann::json& root, const std::string& object);

}  // namespace ngs::io
