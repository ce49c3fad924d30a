#include "ngs/io/capture/colmap_model.h"

#include <array>
#include <cmath>
#include <sstream>

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"

namespace ngs::io {
namespace {

constexpr double kNegligible = 1e-9;  // moves no pixel of a 64k image by more than 1e-4 px
constexpr std::array kModels{ColmapModel{0, "SIMPLE_PINHOLE", 3, 3},
                             ColmapModel{1, "PINHOLE", 4, 4},
                             ColmapModel{2, "SIMPLE_RADIAL", 4, 3},
                             ColmapModel{3, "RADIAL", 5, 3},
                             ColmapModel{4, "OPENCV", 8, 4},
                             ColmapModel{5, "OPENCV_FISHEYE", 8, 4},
                             ColmapModel{6, "FULL_OPENCV", 12, 4},
                             ColmapModel{7, "FOV", 5, 4},
                             ColmapModel{8, "SIMPLE_RADIAL_FISHEYE", 4, 3},
                             ColmapModel{9, "RADIAL_FISHEYE", 5, 3},
                             ColmapModel{10, "THIN_PRISM_FISHEYE", 12, 4}};

/// Fisheye projections bend straight lines even with all parameters zero.
bool is_pinhole_without_distortion(const ColmapModel& model) {
  return std::string(model.name).find("FISHEYE") == std::string::npos && std::string(model.name) != "FOV";
}

std::string undistort_command(const std::string& folder) {
  return "colmap image_undistorter --image_path IMAGES --input_path " + folder +
         " --output_path undistorted --output_type COLMAP, then import the folder undistorted";
}

}  // namespace

const ColmapModel* find_colmap_model_by_id(int id) {
  for (const ColmapModel& model : kModels)
    if (model.id == id) return &model;
  return nullptr;
}

const ColmapModel* find_colmap_model_by_name(const std::string& name) {
  for (const ColmapModel& model : kModels)
    if (model.name == name) return &model;
  return nullptr;
}

void refuse_colmap_model(const std::string& model, const std::string& where, const std::string& folder) {
  throw Error(ErrorCode::kBadInput, where + ": camera model " + model + ", expected a pinhole without distortion",
              undistort_command(folder));
}

Camera pinhole_camera(const ColmapCamera& given, const std::string& where, const std::string& folder) {
  const auto& [model, width, height, parameters] = given;
  if (!is_pinhole_without_distortion(model)) refuse_colmap_model(model.name, where, folder);
  for (std::size_t i = std::size_t(model.intrinsics); i < parameters.size(); ++i) {
    if (std::abs(parameters[i]) < kNegligible) continue;
    std::ostringstream found;
    found << model.name << " with distortion " << parameters[i];
    refuse_colmap_model(found.str(), where, folder);
  }
  if (width < 1 || height < 1 || width > std::uint64_t(kMaxSide) || height > std::uint64_t(kMaxSide))
    throw Error(ErrorCode::kBadInput, where + ": size " + std::to_string(width) + "x" + std::to_string(height) +
                                          " px, expected 1.." + std::to_string(kMaxSide));
  Camera camera;
  camera.width_px = int(width), camera.height_px = int(height);
  const bool one_focal = model.intrinsics == 3;
  camera.fx = parameters[0], camera.fy = parameters[one_focal ? 0 : 1];
  camera.cx = parameters[one_focal ? 1 : 2], camera.cy = parameters[one_focal ? 2 : 3];
  return camera;
}

}  // namespace ngs::io
