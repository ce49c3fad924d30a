#pragma once
// The strokes that say which pieces of the object stay.
#include "ngs/stages/select/touched_pieces.h"
#include "shared/scene/prompt_input.h"

namespace ngs::cli {

/// kUsage for strokes without the scene whose views they are on.
void check_strokes(Run& run, const Inputs& strokes, const Input& scene);

/// Of every stroke on the object, what lies under it in this model.
std::vector<StrokeWeights> stroke_weights_of(const Run& run, const Scene& scene, const Marks& marks,
                                             const GaussianCloud& cloud);

}  // namespace ngs::cli
