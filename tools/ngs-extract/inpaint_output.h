#pragma once
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
#include "extractor.h"
#include "ngs/edit/extract/inpaint_stage.h"

namespace ngs::cli {

/// Throws kUsage for --inpaint without --scene.
void check_inpaint_options(Run& run, const Output& inpaint, const Input& inpainted, const Input& scene);

/// Throws kUsage if the folder is that of the scene, or if a file to be written there is a photo, a mask or the model
/// of the scene, or one of `inputs`.
void check_inpaint_folder(const Scene& scene, const std::string& scene_path, const std::string& folder,
                          std::vector<std::string> inputs);

void write_inpainting(Run& run, const Extractor& extractor, const InpaintOptions& options, const Scene& scene,
                      const std::string& folder);

}  // namespace ngs::cli
