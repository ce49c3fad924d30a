#pragma once
// Which image files lie in a folder, and the same name spelled in several ways.
#include <map>
#include <string>
#include <vector>

namespace ngs::io {

/// The name without a known image extension: "a.b.png" -> "a.b", "frame.0001" -> itself. Folders are kept.
std::string image_stem(const std::string& name);

/// Sorted names of the regular image files in `folder` (not below it); empty if there is no such folder.
std::vector<std::string> list_images(const std::string& folder);
/// Sorted names of the folders in `folder`.
std::vector<std::string> list_folders(const std::string& folder);

/// Finds files by the names that cameras have. Reads each folder once.
class FolderIndex {
 public:
  explicit FolderIndex(std::string folder) : folder_(std::move(folder)) {}

  /// Path of the first of `names` that exists, each tried as given and without its folders; empty: none.
  std::string find(const std::vector<std::string>& names) const;
  /// Path of the only file with the stem of `name`, whatever its extension; empty: none or several.
  std::string find_stem(const std::string& name) const;
  const std::string& folder() const { return folder_; }

 private:
  const std::multimap<std::string, std::string>& stems_of(const std::string& folder) const;

  std::string folder_;
  mutable std::map<std::string, std::multimap<std::string, std::string>> stems_;
};

}  // namespace ngs::io
