#pragma once
// Camera models of COLMAP, shared by its two encodings.
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

struct ColmapModel {
  int id;
  const char* name;
  int parameters;  // in all
  int intrinsics;  // of them at the start: 3 = f cx cy, 4 = fx fy cx cy, 0 = a panorama; the rest is distortion
};

/// Null: unknown (newer than this list).
const ColmapModel* find_colmap_model_by_id(int id);
const ColmapModel* find_colmap_model_by_name(const std::string& name);

/// A camera and its lens.
struct ColmapIntrinsics {
  Camera camera;
  Lens lens;
};
/// By COLMAP's camera id.
using ColmapCameras = std::map<std::int64_t, ColmapIntrinsics>;

/// A camera as the file has it.
struct ColmapCamera {
  const ColmapModel& model;
  std::uint64_t width, height;  // px
  std::vector<double> parameters;
};

/// How the cameras of a model are read; `folder` is what the remedy's command reads.
struct ColmapReading {
  std::string folder;
  Distortion distortion = Distortion::kRefused;
};

/// Size, intrinsics and, where it is kept, distortion.
ColmapIntrinsics intrinsics_of(const ColmapCamera& given, const std::string& where, const ColmapReading& reading);
/// Gives the view of this name its camera, without a pose, and the capture its lens.
void set_intrinsics(const ColmapIntrinsics& from, const std::string& name, Capture& capture, SceneView& view);

/// What to do with panoramas, which no pinhole shows and nothing here undistorts.
inline constexpr const char* kPanoramaRemedy =
    "cut each panorama into pinhole views and find their poses again, e.g. with COLMAP's example panorama_sfm.py or "
    "with "
    "ns-process-data of nerfstudio";

/// kBadInput for a model that is not in the list.
[[noreturn]] void refuse_colmap_model(const std::string& model, const std::string& where, const std::string& folder);

}  // namespace ngs::io
