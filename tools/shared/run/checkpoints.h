#pragma once
// Checkpoints cost no run its result: a folder that can never hold one is found before the work, and a full disk on the
// way is a warning. And they give none that it would not have had: what a run reads is part of what they are of.
#include <cstdint>
#include <functional>
#include <string>

#include "ngs/core/monitor.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

/// Makes the folder and tries to write `path` in it, without leaving anything there. kEnvironment where that fails.
void require_checkpoint_folder(const std::string& folder, const std::string& path);

/// Hashes of what lies in the photos of all views, and in the masks of the training views. Of the contents, not of
/// times: a run may go on elsewhere, on a copy, and reading the files once more is little beside decoding them.
std::string photos_hash(const Scene& scene);
std::string masks_hash(const Scene& scene);

class Checkpoints {
 public:
  explicit Checkpoints(Monitor& monitor) : monitor_(monitor) {}

  /// Where `write` cannot (kEnvironment) the run goes on: the first failure of several in a row is a warning, and what
  /// was written before stays.
  void on_the_way(std::int64_t step, const std::function<void()>& write);
  /// Of a run that was asked to stop: writes unless the state after `step` is kept already. A signal that comes while a
  /// large state is written need not wait for a second writing of it.
  void at_the_stop(std::int64_t step, const std::function<void()>& write);

 private:
  Monitor& monitor_;
  bool failed_ = false;
  std::int64_t kept_step_ = -1;  // -1: none
};

}  // namespace ngs::cli
