#pragma once
// Reads cameras from a folder or file in any known format and matches them with their photos.
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"
#include "ngs/io/files/npy.h"

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

// LLFF's poses_bounds.npy: one row of 17 numbers per image, in the order of the sorted file names: a 3x5 matrix
// [axes | centre | height, width, focal] and the near and far bounds. The axes in the world are (down, right,
// backward). One focal length; no principal point (the image centre is assumed, with a note).

/// `image_names`: sorted names of the images. kInconsistent: their number differs from the number of rows.
Capture llff_capture(const NpyMatrix& poses_bounds, const std::vector<std::string>& image_names,
                     const std::string& object);
Capture read_llff(const std::string& path, const std::vector<std::string>& image_names);

}  // namespace ngs::io
