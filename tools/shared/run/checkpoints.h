#pragma once
// Writing checkpoints never loses a result: an unusable folder is found before the work begins, and a full disk during
// the run is only a warning. Resuming never changes a result: a checkpoint records hashes of the inputs.
#include <cstdint>
#include <functional>
#include <string>

#include "ngs/core/monitor.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

/// Creates the folder and tests that `path` can be written in it; leaves no file. Throws kEnvironment if that fails.
void require_checkpoint_folder(const std::string& folder, const std::string& path);

/// Hashes of the photos of all views, and of the masks of the training views. They hash contents, not times, because a
/// run may be resumed on a copy of the scene. Reading the files again is cheap compared with decoding them.
std::string photos_hash(const Scene& scene);
std::string masks_hash(const Scene& scene);

class Checkpoints {
 public:
  explicit Checkpoints(Monitor& monitor) : monitor_(monitor) {}

  /// If `write` fails (kEnvironment), the run continues and keeps the previous checkpoint; the first of several
  /// failures in a row is a warning.
  void write_during_run(std::int64_t step, const std::function<void()>& write);
  /// For a run that a signal stopped: writes unless the state after `step` is already written. A signal that arrives
  /// while a large state is being written does not have to wait for a second write.
  void write_on_stop(std::int64_t step, const std::function<void()>& write);

 private:
  Monitor& monitor_;
  bool failed_ = false;
  std::int64_t written_step_ = -1;  // -1: none
};

}  // namespace ngs::cli
