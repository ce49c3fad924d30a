#pragma once
// Reads cameras from a folder or file in any known format and matches them with their photos.
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

struct CaptureRequest {
  std::string source;           // COLMAP folder, transforms.json, cameras.json, poses_bounds.npy, the scene.json of
                                //   ngs-scene orbit, or a folder that holds one of them
  std::string images_dir;       // empty: images/ next to the cameras, else the cameras' folder
  std::string world_transform;  // transforms_json.h read_world_transform(); empty: none
  bool original_world = false;  // transforms.json: undo applied_transform
  Distortion distortion = Distortion::kRefused;
};

struct CaptureSource {
  Capture capture;         // cameras at the photos' size, image_path set where a photo was found
  std::string file;        // the file that was read, or the folder of a COLMAP model
  std::string base;        // the folder that is searched for images, masks and models
  std::string images_dir;  // empty: no folder of photos
  // Set for a scene.json of ngs-scene orbit, whose images are renders: how they were rendered, and the model. No views.
  std::optional<Scene> rendered = {};
};

/// The folder that is searched for images, masks and models of a capture: `base` of read_capture(). kBadInput where no
/// cameras are found.
std::string capture_folder(const std::string& source);

/// Missing photos, and images that match no view, give a note. kInconsistent: an explicit images_dir without any photo
/// of the views, or a photo whose aspect ratio differs from its camera's.
CaptureSource read_capture(const CaptureRequest& request);

}  // namespace ngs::io
