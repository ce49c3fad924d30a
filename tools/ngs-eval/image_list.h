#pragma once
// The image files of a folder, or one file, as names relative to the folder.
#include <string>
#include <vector>

namespace ngs::cli {

struct ImageList {
  std::string folder;                   // what the names are relative to
  std::vector<std::string> names;       // sorted; "view.png" or, below folders, "sub/view.png"
  std::vector<std::string> files = {};  // their paths; empty: they lie in `folder`
  std::string path(std::size_t i) const { return files.empty() ? folder + "/" + names[i] : files[i]; }
};

/// Images directly in the folder, or, if there are none, those of its sub-folders, up to three deep. Hidden entries are
/// skipped. Throws kBadInput where there is no image.
ImageList list_images(const std::string& path);

}  // namespace ngs::cli
