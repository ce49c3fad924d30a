#pragma once
// Lists the image files of a folder and finds files whose names differ in spelling.
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ngs/core/folded_name.h"

namespace ngs::io {

/// Whether macOS added the entry to an archive, "._NAME" or __MACOSX: it describes another file.
bool is_resource_fork(std::string_view name);

/// Sorted names of the regular image files in `folder`, not recursive, without resource forks; empty if there is no
/// such folder.
std::vector<std::string> list_images(const std::string& folder);
/// Throws kBadInput if the folder exists, and its files cannot be listed or looked at for lack of rights.
void require_readable_folder(const std::string& folder);

/// Sorted names of the folders in `folder`.
std::vector<std::string> list_folders(const std::string& folder);

/// Path of the sub-folder with this name, else of the only one that differs in case; empty: none.
std::string folder_called(const std::string& folder, const std::string& name);

/// Finds files by camera name. Reads each folder once.
class FolderIndex {
 public:
  explicit FolderIndex(std::string folder) : folder_(std::move(folder)) {}

  /// Path of the file with this name, else of the only one whose extension differs in case, else of the only one that
  /// differs in case or Unicode form (core/folded_name.h); empty: none.
  std::string find(const std::string& name) const;
  /// Path of the only file with the stem of `name`, in the same spelling or else in another, and any extension; empty:
  /// none or several.
  std::string find_stem(const std::string& name) const;
  const std::string& folder() const { return folder_; }

 private:
  struct Stems {
    std::multimap<std::string, std::string> exact, folded;  // stem -> file name
  };
  const Stems& stems_of(const std::string& folder) const;

  std::string folder_;
  mutable std::map<std::string, Stems> stems_;
};

struct FoundFile {
  std::string path, rule;             // empty: none
  std::string unused_candidate = {};  // a second file, which a later rule would have found
};
/// Finds the file for a view name, folders included.
using FindFile = std::function<FoundFile(const std::string& name)>;

/// The file of each view: find(name) or, if that finds nothing, find(name without its folders), unless that file is
/// another view's by full name. Throws kInconsistent if several views match one file this way (cam0/0001, cam1/0001),
/// or by their common stem (0000.jpg, 0000.tif) while the file repeats the whole name of none or of several.
std::vector<FoundFile> files_of_views(const std::vector<std::string>& views, const FindFile& find);

}  // namespace ngs::io
