#pragma once
// Which photo belongs to which view: the file of the view's name, or the only one with its stem (0000.HEIC is
// 0000.jpg), then the same without the folders of the name, if it is one view's only (files_of_views).
#include <string>
#include <vector>

#include "ngs/io/capture/capture.h"

namespace ngs::io {

struct PhotoFolder {
  std::string path;       // empty: none is known
  bool is_named = false;  // by the user: it comes before the paths that the cameras' file names
};

/// The first of `folders` that holds a photo of a view whose own path names no file; empty: none does.
std::string folder_with_photos(const std::vector<std::string>& folders, const Capture& capture);

/// Sets image_path of every view, empty where there is no photo. Notes missing photos, and photos of another format
/// than the cameras name. kInconsistent: a folder that the user names has no photo of any view.
void attach_photos(const PhotoFolder& folder, Capture& capture);

/// Notes pictures beside the photos that are of no view, and other folders in `base` with pictures that are called like
/// a view without a photo.
void note_unused_photos(const std::string& base, Capture& capture);

}  // namespace ngs::io
