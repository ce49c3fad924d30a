#include "ngs/io/capture/cameras_json.h"

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/json_file.h"

namespace ngs::io {

Capture parse_cameras_json(const nlohmann::json& root, const std::string& object) {
  if (!root.is_array())
    throw Error(ErrorCode::kBadInput, object + ": " + root.type_name() + ", expected a list of cameras");
  Capture capture;
  capture.format = "cameras.json";
  bool assumes_centre = false;  // some entry has no principal point
  for (const nlohmann::json& entry : root) {
    const JsonReader reader(entry, object + ": [" + std::to_string(capture.views.size()) + "]");
    Camera& camera = capture.views.emplace_back().camera;
    camera.name = reader.text("img_name");
    camera.width_px = int(reader.integer("width", 1, kMaxSide));
    camera.height_px = int(reader.integer("height", 1, kMaxSide));
    camera.fx = reader.number("fx"), camera.fy = reader.number("fy");
    assumes_centre |= !reader.has("cx") || !reader.has("cy");
    camera.cx = reader.number_or("cx", camera.width_px / 2.0);
    camera.cy = reader.number_or("cy", camera.height_px / 2.0);
    const std::vector<double> rows = reader.matrix("rotation", 3, 3), centre = reader.matrix("position", 3, 0);
    Mat3<double> axes;
    std::copy(rows.begin(), rows.end(), axes.m);
    set_pose(camera, checked_rotation(axes, reader.where() + ".rotation"), vec3(centre.data()));
  }
  if (assumes_centre)
    capture.notes.push_back(object + ": the format has no principal point, the image centre is assumed");
  finish_capture(capture, object);
  return capture;
}

Capture read_cameras_json(const std::string& path) { return parse_cameras_json(read_json_file(path), path); }

}  // namespace ngs::io
