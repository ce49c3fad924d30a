#pragma once
// A FitState on disk: DIR/fit.safetensors, written by rename. It holds everything that later steps read, so a run
// that goes on from it ends with the bytes of one that was never interrupted.
#include <string>
#include <vector>

#include "ngs/options/field.h"
#include "ngs/options/option_set.h"
#include "ngs/stages/fit/fit_stage.h"

namespace ngs::cli {

struct CheckpointOptions {
  std::string checkpoint;
  int checkpoint_every = 1000;
  bool resume = false;

  bool is_on() const { return !checkpoint.empty(); }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.checkpoint, Text{"checkpoint", "DIR", "keep what is needed to go on in this folder"});
    visit(self.checkpoint_every,
          Field<int>{"checkpoint_every", "steps", "and when a signal asks to stop", 1, 10000000});
    visit(self.resume, Flag{"resume", "go on from --checkpoint where there is one"});
  }
};

/// Hashes of the files that a fit reads beside the scene (shared/run/checkpoints.h, io/files/content_hash.h); points:
/// empty without.
struct FitFiles {
  std::string photos, points;
};

/// What must be equal for a checkpoint to be continued: options, seed, the views' names, sizes, splits and cameras, and
/// what lay in the files.
std::string fit_identity(const FitOptions& options, std::uint64_t seed, const std::vector<FitView>& views,
                         const FitFiles& files);

std::string checkpoint_path(const std::string& folder);
/// The folder is there (shared/run/checkpoints.h).
void write_checkpoint(const std::string& folder, const FitState& state, const std::string& identity);
/// Another identity is kInconsistent; shapes that do not fit together, numbers that are not finite and a step beyond
/// the last of `steps` are kBadInput.
FitState read_checkpoint(const std::string& folder, const std::string& identity, std::int64_t steps);

}  // namespace ngs::cli
