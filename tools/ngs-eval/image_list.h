#pragma once
// Lists the images of a folder, or a single file, with names relative to the folder.
#include <string>
#include <vector>

namespace ngs::cli {

struct ImageList {
  std::string folder;                   // base of the names
  std::vector<std::string> names;       // sorted; "view.png" or, below folders, "sub/view.png"
  std::vector<std::string> files = {};  // their paths; empty: they are in `folder`
  std::string path(std::size_t i) const { return files.empty() ? folder + "/" + names[i] : files[i]; }
};

/// Images directly in the folder, or, if there are none, those of its sub-folders, up to three levels deep. Skips
/// hidden entries. Throws kBadInput if there is no image.
ImageList list_images(const std::string& path);

}  // namespace ngs::cli
