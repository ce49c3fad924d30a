#pragma once
// Files that an earlier run left in an output folder and that a run with -w did not replace. They could be mistaken for
// its results.
#include <map>
#include <string>
#include <vector>

#include "shared/os/files.h"

namespace ngs::cli {

class Leftovers {
 public:
  /// Lists the files in the folder before the run; none if the folder does not exist.
  explicit Leftovers(std::string folder);

  const std::string& folder() const { return folder_; }
  /// Sorted names, relative to the folder, of unchanged files whose extension the run has written too.
  std::vector<std::string> untouched() const;

 private:
  static std::map<std::string, os::FileVersion> files_in(const std::string& folder);

  std::string folder_;
  std::map<std::string, os::FileVersion> before_;
};

}  // namespace ngs::cli
