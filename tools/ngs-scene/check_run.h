#pragma once
// Checks of capture/scene_check.h on files, shared by import and check; and the model settings that import
// estimates from the photos: background, low-pass filter, camera corrections.
#include <optional>
#include <string>
#include <vector>

#include "ngs/capture/scene_check.h"
#include "ngs/io/image/photo.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/scene/import_scene.h"
#include "ngs/render/background.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::scene_tool {

/// nullopt: the scene names no model.
using Model = std::optional<io::GaussianPly>;

/// Writes estimates to the scene and measurements to "result" of the report. Call the steps in the order below; steps
/// that need a model or photos do nothing without them.
class SceneChecks {
 public:
  /// Reads the scene's model and reports its health. `notes` become warnings.
  SceneChecks(cli::Run& run, const SceneCheckOptions& options, Scene& scene, std::vector<std::string> notes);

  /// Keeps alpha channels as masks only if the model covers the pixels that they hide. Without a model, or with a model
  /// of the object alone, drops these masks with a note.
  void validate_alpha_masks();
  /// Drops photos whose hidden pixels have one colour, because training would compare these pixels; keeps the masks.
  /// Call it after all other steps, which compare visible pixels only.
  void drop_emptied_photos();
  /// For photos with transparency: sets the background to black or white, whichever fits the model better, with a note.
  /// False: the photos are opaque, the scene is unchanged.
  bool choose_background_of_transparent_photos();
  /// Reads photos and masks and prints the table. Notes are printed after the checks, so that an error comes first on
  /// stderr. Throws if the parts of the scene do not fit. `compat_is_default`: the renderer was not given; the scene's
  /// compat becomes the one that explains the photos better.
  void check(bool compat_is_default = false);
  /// Removes empty masks that contradict the masks of other views.
  void leave_out_lost_masks();
  /// Estimates the low-pass filter of the model (capture/filter_probe.h), unless it is given.
  void find_filter(double given_px2);
  /// Aligns the cameras to the model (capture/view_align.h). `for_background`: also measures the background, so
  /// that find_background() needs no render.
  void align_views(bool for_background);
  /// Estimates the background from the photos (render/background.h).
  void find_background();

 private:
  PhotographedModel photographed();
  RenderedView rendered(std::size_t view) const;
  /// The photo to compare with the model. Pixels that its own mask hides are taken from the model's rendering.
  ImageF photo(std::size_t view);

  cli::Run& run_;
  const SceneCheckOptions& options_;
  Scene& scene_;
  std::vector<std::string> notes_;
  std::vector<std::size_t> compared_;  // views compared with the model
  io::PhotoCache photos_;              // photos of compared_
  Model model_;
  std::vector<BackgroundMeasurement> measurements_;
  std::vector<std::size_t> lost_masks_;  // views with contradicted empty masks
};

/// The checks of ngs-scene import for a scene of ngs-scene orbit. Keeps the model settings of the renders: estimates no
/// filter, background or alignment, and warns if their options are given.
void check_renders(cli::Run& run, const SceneCheckOptions& checks, io::ImportedScene& imported);

}  // namespace ngs::scene_tool
