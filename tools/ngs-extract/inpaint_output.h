#pragma once
// The folder that an inpainting tool starts from.
//
//   background.ply            what is left, plain 3DGS
//   images/STEM.png           it, rendered at the scene's cameras (black where nothing is)
//   holes/STEM.png            255: nobody knows what is there        dilated/STEM.png   the same with a
//   margin sparse/0/*.txt            the cameras, COLMAP text, one per image scene.json                the
//   same for ngs: model, images, and the dilated holes as masks
#include "extractor.h"
#include "ngs/stages/inpaint_stage.h"

namespace ngs::cli {

void write_inpainting(Run& run, const Extractor& extractor, const InpaintOptions& options, const Scene& scene,
                      const std::string& folder);

}  // namespace ngs::cli
