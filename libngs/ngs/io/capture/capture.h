#pragma once
// What the readers of camera files (COLMAP, nerfstudio, LLFF, ...) return.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "ngs/io/image/image_file.h"
#include "ngs/math/lens.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

/// Cameras as read from the source. `views` are sorted by name. `image_path` and `mask_path` are set only where the
/// source itself names the files (transforms.json); they are resolved against its folder.
struct Capture {
  std::string format;  // "COLMAP binary", ...
  std::vector<SceneView> views;
  std::vector<std::string> notes;      // assumptions made where the format has no value
  std::map<std::string, Lens> lenses;  // by camera name; no entry: a pinhole
};

/// How a reader treats a camera with distortion.
enum class Distortion : std::uint8_t {
  kRefused,  // kBadInput, the hint has the command that undistorts
  kKept      // stored in Capture::lenses; kBadInput for an unknown camera model
};

/// File system queries about images that a reader needs; tests and fuzzers pass their own functions.
struct ImageFinder {
  std::function<bool(const std::string&)> exists;
  std::function<ImageSize(const std::string&)> size;
};
ImageFinder images_on_disk();

/// Sorts the views by name. kBadInput for a capture without views, a repeated name or an invalid camera.
void finish_capture(Capture& capture, const std::string& object);

}  // namespace ngs::io
