#pragma once
// The folder halves/ of ngs-synth: the truth of a cut.
//
// clang-format off
//   background/scene.json  the room without the target: cameras of the scene (split train) and 24 more (held-out)
//   background/images/NAME.png                  photos
//   background/masks/NAME.png                   0/255, the hole: pixels where the full scene shows the target
//   background/depth/NAME.exr                   Z: camera z of the room without the target
//   object/scene.json      the target alone, from 64 directions all round
//   object/images/NNNN.png                      RGBA; alpha: share of the pixel that the target covers
// clang-format on
#include <string>

#include "dataset.h"
#include "shared/run/run.h"

namespace ngs::cli {

/// Number of views that write_halves() renders; 0 without hole cameras.
std::size_t views_of_halves(const SynthData& data);

/// Writes both halves into `folder`. Returns early after a stop request.
void write_halves(Run& run, const std::string& folder, const SynthData& data);

}  // namespace ngs::cli
