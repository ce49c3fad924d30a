#pragma once
// A FitState on disk: DIR/fit.safetensors, written atomically. It contains everything that later steps read, so a
// resumed run writes the same bytes as an uninterrupted one.
#include <string>
#include <vector>

#include "ngs/make/fit/fit_stage.h"
#include "ngs/options/field.h"
#include "ngs/options/option_set.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct CheckpointOptions {
  std::string checkpoint;
  int checkpoint_every = 1000;
  bool resume = false;

  bool is_on() const { return !checkpoint.empty(); }

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.checkpoint, Text{"checkpoint", "DIR", "Folder for checkpoints of the run"});
    visit(self.checkpoint_every,
          Field<int>{"checkpoint_every", "steps", "Steps between checkpoints; a signal writes one too", 1, 10000000});
    visit(self.resume, Flag{"resume", "Continue from the checkpoint in --checkpoint, if there is one"});
  }
};

/// Hashes of the files that a fit reads besides the scene (shared/run/checkpoints.h, io/files/content_hash.h). points:
/// empty without --points.
struct FitFiles {
  std::string photos, points;
};

/// The values that must match to resume from a checkpoint: options, seed, the views' names, sizes, splits and cameras,
/// and the hashes of the files.
std::string fit_identity(const FitOptions& options, std::uint64_t seed, const std::vector<FitView>& views,
                         const FitFiles& files);

std::string checkpoint_path(const std::string& folder);
/// The folder must exist (shared/run/checkpoints.h).
void write_checkpoint(const std::string& folder, const FitState& state, const std::string& identity);
/// Throws kInconsistent if the identity differs; kBadInput for inconsistent shapes, values that are not finite and a
/// step beyond `steps`.
FitState read_checkpoint(const std::string& folder, const std::string& identity, std::int64_t steps);

// Inputs of a fit, its plan and its metadata.

/// All views of the scene that have a photo.
std::vector<FitView> load_views(Run& run, const Scene& scene);
/// Empty, with a warning, if no file is given; also warns if there are more points than --max-gaussians.
std::vector<FitPoint> load_points(Run& run, const FitOptions& options, const Input& input);

Json fit_plan(const FitOptions& options, const Scene& scene, bool resumes, int threads);
/// The comment in the model file.
std::string history(const FitOptions& options);
Json score_json(const FitScore& score);

/// Reads the scene, applies the background option and records the background in `options` for the report.
Scene read_fit_scene(Run& run, const std::string& path, FitOptions& options);

}  // namespace ngs::cli
