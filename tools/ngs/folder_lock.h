#pragma once
// Keeps a second run out of an output folder.
#include <string>

namespace ngs::ngs_tool {

class FolderLock {
 public:
  /// `folder` exists. Throws kEnvironment if another run holds it. The lock ends with this object or the process. Where
  /// the system has no locks, nothing is locked.
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace ngs::ngs_tool
