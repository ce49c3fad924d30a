#include "shared/run/checkpoints.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <vector>

#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/content_hash.h"
#include "ngs/io/image/masks.h"

namespace ngs::cli {

void require_checkpoint_folder(const std::string& folder, const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::kEnvironment,
                folder + ": " + error.message() + ", expected a writable folder for checkpoints",
                "name another folder with --checkpoint");
  const io::AtomicFile unfinished(path);
}

std::string photos_hash(const Scene& scene) {
  std::vector<std::string> files;
  for (const SceneView& view : scene.views)
    if (!view.image_path.empty()) files.push_back(view.image_path);
  return io::files_hash(files);
}

std::string masks_hash(const Scene& scene) {
  std::vector<std::string> files;
  for (std::size_t v = 0; v < scene.views.size(); ++v)
    if (scene.views[v].split == Split::kTrain) std::ranges::copy(io::mask_files(scene, v), std::back_inserter(files));
  return io::files_hash(files);
}

void Checkpoints::write_during_run(std::int64_t step, const std::function<void()>& write) {
  try {
    write();
    failed_ = false;
    written_step_ = step;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kEnvironment) throw;
    if (!failed_)
      monitor_.warn("the checkpoint was not written, the run continues without it: " + std::string(e.what()));
    failed_ = true;
  }
}

void Checkpoints::write_on_stop(std::int64_t step, const std::function<void()>& write) {
  if (step == written_step_) return;
  write();
  written_step_ = step;
}

}  // namespace ngs::cli
