#pragma once
// Writes the input folder for an inpainting tool.
//
// background.ply model without the object, plain 3DGS
//   images/STEM.png     it, rendered at the scene's cameras, over the scene's background
//   holes/STEM.png      255: nobody knows what is there
//   dilated/STEM.png    the same with a margin
//   sparse/0/*.txt      the cameras, COLMAP text, one per image
//   scene.json          the same for ngs: model, images at the working size, and the dilated holes as masks
#include "extractor.h"
#include "ngs/stages/extract/inpaint_stage.h"

namespace ngs::cli {

/// kUsage for the folder without a scene.
void check_inpaint_options(Run& run, const Output& inpaint, const Input& scene);

/// kUsage where the folder is that of the scene, or where a file that will be written there is a photo, a mask or the
/// model of the scene, or one of `inputs`: they would be replaced.
void check_inpaint_folder(const Scene& scene, const std::string& scene_path, const std::string& folder,
                          std::vector<std::string> inputs);

void write_inpainting(Run& run, const Extractor& extractor, const InpaintOptions& options, const Scene& scene,
                      const std::string& folder);

}  // namespace ngs::cli
