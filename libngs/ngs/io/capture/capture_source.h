#pragma once
// A folder or file in any of the known conventions -> cameras with their photos.
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

struct CaptureRequest {
  std::string source;           // COLMAP folder, transforms.json, cameras.json, poses_bounds.npy, the scene.json of
                                //   ngs-scene orbit, or a folder that holds one of them
  std::string images_dir;       // empty: images/ beside the cameras, else where the cameras are
  std::string world_transform;  // transforms_json.h read_world_transform(); empty: none
  bool original_world = false;  // transforms.json: undo applied_transform
  Distortion distortion = Distortion::kRefused;
};

struct CaptureSource {
  Capture capture;         // cameras at the photos' size, image_path set where a photo was found
  std::string file;        // what was read: a file, or the folder of a COLMAP model
  std::string base;        // the folder where images, masks and models are looked for
  std::string images_dir;  // empty: no folder of photos
  // Of a scene.json, whose pictures are renders: how they were rendered, and of which model. Without views.
  std::optional<Scene> rendered = {};
};

/// Where images, masks and models of a capture are looked for: `base` of read_capture(). kBadInput as there where no
/// cameras are found.
std::string capture_folder(const std::string& source);

/// Missing photos are a note, and so are pictures that are of no view; no photo at all with an explicit images_dir, or
/// a photo of another shape than its camera's image, is kInconsistent.
CaptureSource read_capture(const CaptureRequest& request);

}  // namespace ngs::io
