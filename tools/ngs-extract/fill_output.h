#pragma once
// The background with its hole filled (--background-filled, --inpainted), and the added Gaussians alone.
#include <optional>
#include <string>

#include "extractor.h"
#include "inpainted_input.h"
#include "ngs/edit/extract/unseen_surface.h"
#include "ngs/edit/fill/fill_stage.h"
#include "outputs.h"

namespace ngs::cli {

/// Throws kUsage for --filled with --fill off, and for --inpainted without a scene or an output that it changes;
/// warns about --fill without such an output.
void check_fill_options(Run& run, const FillOptions& options, const Input& inpainted, const Input& scene,
                        const Outputs& out);

class FillOutput {
 public:
  /// Call it after Extractor::decide(). Fills the hole unless the option is off, adds "fill" to the result, and prints
  /// one line. With `inpainted` the added Gaussians are refitted to the pictures.
  FillOutput(Run& run, const Extractor& extractor, FillOptions options, InpaintedPictures* inpainted);

  /// Writes the requested ones of --background-ply, --background-filled and --filled. If nothing was filled, the second
  /// is not written, and a file of an earlier run is removed.
  void write(const Outputs& out) const;

 private:
  void refit(InpaintedPictures& inpainted);
  void report(const FillOptions& options);
  std::vector<std::string> comments() const;
  /// PLY: with the column ngs_filled and the comment ngs-fill.
  void write_rows(const std::string& path, const GaussianCloud& cloud, std::size_t kept) const;

  Run& run_;
  const Extractor& extractor_;
  std::optional<HoleFill> fill_;
  GaussianCloud background_;  // with a fill: without the removed rows, and with the added ones at its end
  std::size_t kept_ = 0;      // its rows that are not added
  Json report_;               // of the comment
};

// Writes the input folder for an inpainting tool.
//
// clang-format off
//   background.ply      the model without the object, plain 3DGS
//   images/STEM.png     background.ply rendered at the scene's cameras, over the scene's background colour
//   holes/STEM.png      255: pixels to inpaint, which no view shows without the object
//   dilated/STEM.png    the same with a margin
//   sparse/0/*.txt      the cameras as COLMAP text, one per image
//   scene.json          the same for ngs: model, images at the working size, and the dilated holes as masks
// clang-format on

/// Throws kUsage for --inpaint without --scene.
void check_inpaint_options(Run& run, const Output& inpaint, const Input& inpainted, const Input& scene);

/// kUsage if the folder is the scene's, or a file to be written is its photo, mask or model, or one of `inputs`.
void check_inpaint_folder(const Scene& scene, const std::string& scene_path, const std::string& folder,
                          std::vector<std::string> inputs);

void write_inpainting(Run& run, const Extractor& extractor, const InpaintOptions& options, const Scene& scene,
                      const std::string& folder);

}  // namespace ngs::cli
