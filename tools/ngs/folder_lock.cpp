#include "folder_lock.h"

#include <cerrno>

#include "ngs/core/error.h"
#include "shared/os/files.h"

namespace ngs::ngs_tool {

FolderLock::FolderLock(const std::string& folder) : descriptor_(os::lock_folder(folder)) {
  if (descriptor_ < 0 && errno == EWOULDBLOCK)
    throw Error(ErrorCode::kEnvironment, folder + ": another run writes here, expected none",
                "wait until it has ended, or choose another folder with -o");
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) os::unlock_folder(descriptor_);
}

}  // namespace ngs::ngs_tool
