#pragma once
// cameras.json beside a trained 3DGS model: a list of {id, img_name, width, height, position, rotation, fx,
// fy}; position = camera centre, rotation = camera -> world, x right, y down, z forward. The format has no
// principal point (without a cx and cy of its own the image's centre is assumed, with a note) and often no file
// extension.
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

Capture read_cameras_json(const std::string& path);
Capture parse_cameras_json(const nlohmann::json& root, const std::string& object);

}  // namespace ngs::io
