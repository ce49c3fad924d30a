#pragma once
// Which image files lie in a folder, and the same name spelled in several ways.
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::io {

/// Sorted names of the regular image files in `folder` (not below it); empty if there is no such folder.
std::vector<std::string> list_images(const std::string& folder);
/// Sorted names of the folders in `folder`.
std::vector<std::string> list_folders(const std::string& folder);

/// With letters of ASCII in lower case.
std::string lower_case(std::string_view name);
/// Path of the sub-folder of this name, else of the only one that differs in case; empty: none.
std::string folder_called(const std::string& folder, const std::string& name);

/// Finds files by the names that cameras have. Reads each folder once.
class FolderIndex {
 public:
  explicit FolderIndex(std::string folder) : folder_(std::move(folder)) {}

  /// Path of the file of this name, else of the only one that differs in the case of its extension; empty: none.
  std::string find(const std::string& name) const;
  /// Path of the only file with the stem of `name`, whatever its extension; empty: none or several.
  std::string find_stem(const std::string& name) const;
  const std::string& folder() const { return folder_; }

 private:
  const std::multimap<std::string, std::string>& stems_of(const std::string& folder) const;

  std::string folder_;
  mutable std::map<std::string, std::multimap<std::string, std::string>> stems_;
};

struct FoundFile {
  std::string path, rule;      // empty: none
  std::string beside_it = {};  // one that a later rule would have found
};
/// A file called after the name, folders included.
using FindFile = std::function<FoundFile(const std::string& name)>;

/// The file of each view: what `find` says to its name or, if no view has that file so, to the name without its
/// folders. Throws kInconsistent where several views have one file by their bare names (cam0/0001, cam1/0001).
std::vector<FoundFile> files_of_views(const std::vector<std::string>& views, const FindFile& find);

}  // namespace ngs::io
