#include "shared/checkpoints.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/atomic_file.h"

namespace ngs::cli {

void require_checkpoint_folder(const std::string& folder, const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::kEnvironment, folder + ": " + error.message() + ", expected a folder to keep a checkpoint in",
                "name another folder with --checkpoint");
  const io::AtomicFile unfinished(path);
}

void Checkpoints::on_the_way(const std::function<void()>& write) {
  try {
    write();
    failed_ = false;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kEnvironment) throw;
    if (!failed_) monitor_.warn("the checkpoint was not written, the run goes on without it: " + std::string(e.what()));
    failed_ = true;
  }
}

}  // namespace ngs::cli
