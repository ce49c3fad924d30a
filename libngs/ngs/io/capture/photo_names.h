#pragma once
// Matches photos with views. A view's photo is the file of its name, else the only file with its stem (0000.HEIC for
// 0000.jpg). If neither exists, both rules are tried without the folders of the name, if only one view fits
// (files_of_views).
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

struct PhotoFolder {
  std::string path;       // empty: no folder
  bool is_named = false;  // by the user: takes precedence over image paths in the camera file
};

/// The first of `folders` with a photo of a view whose own image_path does not exist; empty: none.
std::string folder_with_photos(const std::vector<std::string>& folders, const Capture& capture);

/// Sets image_path of every view; empty if there is no photo. Notes missing photos, and photos whose file extension
/// differs from the camera file's. kInconsistent: a folder named by the user has no photo of any view.
void attach_photos(const PhotoFolder& folder, Capture& capture);

/// Notes images in the photo folders that match no view, and other folders in `base` whose images have the names of
/// views without a photo.
void note_unused_photos(const std::string& base, Capture& capture);

}  // namespace ngs::io
