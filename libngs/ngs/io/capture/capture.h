#pragma once
// What the readers of foreign camera files return.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "ngs/io/image/image_file.h"
#include "ngs/math/lens.h"
#include "ngs/scene/scene.h"

namespace ngs::io {

/// Cameras as the source has them. `views` are sorted by name; `image_path` and `mask_path` are set only
/// where the source itself names the files (transforms.json), resolved against its folder.
struct Capture {
  std::string format;  // "COLMAP binary", ...
  std::vector<SceneView> views;
  std::vector<std::string> notes;      // what the format does not say and was assumed
  std::map<std::string, Lens> lenses;  // by the camera's name; a camera without is a pinhole
};

/// What a reader makes of a camera with distortion.
enum class Distortion : std::uint8_t {
  kRefused,  // kBadInput, with what undoes it
  kKept      // in Capture::lenses; kBadInput where the model is unknown
};

/// What a reader may ask the disk about images; tests and fuzzers pass their own answers.
struct ImageFinder {
  std::function<bool(const std::string&)> exists;
  std::function<ImageSize(const std::string&)> size;
};
ImageFinder images_on_disk();

/// Sorts by name and refuses (kBadInput) a capture without views, repeated names and invalid cameras.
void finish_capture(Capture& capture, const std::string& object);

}  // namespace ngs::io
