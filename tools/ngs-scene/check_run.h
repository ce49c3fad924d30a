#pragma once
// The checks of stages/scene/scene_check.h with files behind them, which import and check have in common; and what
// import finds out about a model by its photos.
#include <optional>
#include <string>
#include <vector>

#include "ngs/io/image/photo_cache.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/render/background.h"
#include "ngs/stages/scene/scene_check.h"
#include "shared/run/run.h"

namespace ngs::capture {

/// Empty: the scene names no model.
using Model = std::optional<io::GaussianPly>;

/// What is found goes into the scene, what was measured into "result" of the report. Steps in the order of this class;
/// without a model or photos those that need them do nothing.
class SceneChecks {
 public:
  /// Reads the scene's model into memory, its health into the report. `notes` become warnings.
  SceneChecks(cli::Run& run, const SceneCheckOptions& options, Scene& scene, std::vector<std::string> notes);

  /// Where the background shows through photos, no photo tells it: black or white, whichever the model fits better
  /// over, with a note. False: the photos are opaque, and nothing was done.
  bool settle_transparent_photos();
  /// Reads photos and masks, prints the table. Notes are told after the checks: an error must stand first on stderr.
  /// Throws where the scene does not hold together. `compat_is_default`: nobody has said which renderer fitted the
  /// model; the scene's compat becomes what explains the photos.
  void check(bool compat_is_default = false);
  /// Views whose empty masks the others contradict become views without a mask.
  void leave_out_lost_masks();
  /// The low-pass filter of the model (stages/scene/filter_probe.h).
  void find_filter();
  /// Moves the cameras to where the photos fit the model (stages/scene/view_align.h). `for_background`: the photos are
  /// also asked for the background, which find_background() then knows without a render.
  void align_views(bool for_background);
  /// The background that the photos tell (stages/render/background.h).
  void find_background();

 private:
  PhotographedModel photographed();

  cli::Run& run_;
  const SceneCheckOptions& options_;
  Scene& scene_;
  std::vector<std::string> notes_;
  std::vector<std::size_t> compared_;  // views
  io::PhotoCache photos_;              // of these, of which every step asks for some
  Model model_;
  std::vector<BackgroundMeasurement> measurements_;
  std::vector<std::size_t> lost_masks_;  // views
};

int check_command(int argc, char** argv);

}  // namespace ngs::capture
