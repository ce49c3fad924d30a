#include "ngs/io/capture/capture.h"

#include <algorithm>

#include "ngs/core/error.h"
#include "ngs/io/capture/pose.h"
#include "ngs/io/files/regular_file.h"

namespace ngs::io {

ImageFinder images_on_disk() { return {is_regular_file, read_image_size}; }

void finish_capture(Capture& capture, const std::string& object) {
  if (capture.views.empty()) throw Error(ErrorCode::kBadInput, object + ": no cameras, expected at least one");
  for (const SceneView& view : capture.views) validate_camera(view.camera, object);
  std::stable_sort(capture.views.begin(), capture.views.end(),
                   [](const SceneView& a, const SceneView& b) { return a.camera.name < b.camera.name; });
  const auto same =
      std::adjacent_find(capture.views.begin(), capture.views.end(),
                         [](const SceneView& a, const SceneView& b) { return a.camera.name == b.camera.name; });
  if (same != capture.views.end())
    throw Error(ErrorCode::kBadInput, object + ": image " + same->camera.name + " is listed twice, expected once");
}

}  // namespace ngs::io
