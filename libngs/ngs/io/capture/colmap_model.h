#pragma once
// COLMAP's camera models, for the binary and the text reader. To add one: its line in kModels (colmap_model.cpp).
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

struct ColmapModel {
  int id;
  const char* name;
  int parameters;  // in all
  int intrinsics;  // leading parameters: 3 = f cx cy, 4 = fx fy cx cy, 0 = a panorama; then distortion
  Lens::Kind kind;
  // The member of Lens that each distortion parameter sets: radial, tangential, divisor, s (prism) or f (fov_rad).
  // Empty although there are such parameters: Lens cannot represent them.
  std::string_view distortion;
};

/// Null: a model that is not in the list.
const ColmapModel* find_colmap_model_by_id(int id);
const ColmapModel* find_colmap_model_by_name(const std::string& name);

struct ColmapIntrinsics {
  Camera camera;
  Lens lens;
};
/// By COLMAP's camera id.
using ColmapCameras = std::map<std::int64_t, ColmapIntrinsics>;

struct ColmapCamera {
  const ColmapModel& model;
  std::uint64_t width, height;  // px
  std::vector<double> parameters;
};

/// How to read the cameras of a model; `folder` appears in the command of the hint.
struct ColmapReading {
  std::string folder;
  Distortion distortion = Distortion::kRefused;
};

/// Converts size, intrinsics and, with Distortion::kKept, distortion.
ColmapIntrinsics intrinsics_of(const ColmapCamera& given, const std::string& where, const ColmapReading& reading);
/// Sets the camera (without its pose) and the name of `view`, and stores the lens in `capture`.
void set_intrinsics(const ColmapIntrinsics& from, const std::string& name, Capture& capture, SceneView& view);

/// Hint for panoramas, which neither a pinhole nor any Lens can represent.
inline constexpr const char* kPanoramaRemedy =
    "cut each panorama into pinhole views and find their poses again, e.g. with COLMAP's example panorama_sfm.py or "
    "with ns-process-data of nerfstudio";

/// The command that removes lens distortion. `folder`: the model.
std::string undistort_command(const std::string& images, const std::string& folder);

/// kBadInput for a model that is not in the list.
[[noreturn]] void refuse_colmap_model(const std::string& model, const std::string& where, const std::string& folder);

}  // namespace ngs::io
