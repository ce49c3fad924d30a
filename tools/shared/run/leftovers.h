#pragma once
// Files in the folder of an output that a run with -w finds there and does not replace. They look like its results.
#include <map>
#include <string>
#include <vector>

namespace ngs::cli {

class Leftovers {
 public:
  /// Notes what lies in the folder before the run; nothing where it does not exist.
  explicit Leftovers(std::string folder);

  const std::string& folder() const { return folder_; }
  /// Sorted names, relative to the folder, of the files that are still those noted, and of a kind (by extension) that
  /// the run has written.
  std::vector<std::string> untouched() const;

 private:
  struct File {
    unsigned long inode = 0;  // an output that replaces a file is another one
    long long written_ns = 0;
    bool operator==(const File&) const = default;
  };
  static std::map<std::string, File> files_in(const std::string& folder);

  std::string folder_;
  std::map<std::string, File> before_;
};

}  // namespace ngs::cli
