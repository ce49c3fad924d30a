#pragma once
// Camera models of COLMAP, shared by its two encodings.
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ngs/scene/camera.h"

namespace ngs::io {

struct ColmapModel {
  int id;
  const char* name;
  int parameters;  // in all
  int intrinsics;  // of them at the start: 3 = f cx cy, 4 = fx fy cx cy; the rest is distortion
};

/// Null: unknown (newer than this list).
const ColmapModel* find_colmap_model_by_id(int id);
const ColmapModel* find_colmap_model_by_name(const std::string& name);

/// COLMAP camera id -> size and intrinsics.
using ColmapCameras = std::map<std::int64_t, Camera>;

/// A camera as the file has it.
struct ColmapCamera {
  const ColmapModel& model;
  std::uint64_t width, height;  // px
  std::vector<double> parameters;
};

/// Size and intrinsics; distortion >= 1e-9 is kBadInput. `folder` is what the remedy's command reads.
Camera pinhole_camera(const ColmapCamera& given, const std::string& where, const std::string& folder);

/// kBadInput for a model that is not in the list.
[[noreturn]] void refuse_colmap_model(const std::string& model, const std::string& where, const std::string& folder);

}  // namespace ngs::io
