#pragma once
// The strokes that select components of the object.
#include "ngs/edit/select/touched_pieces.h"
#include "shared/scene/prompt_input.h"

namespace ngs::cli {

/// Throws kUsage for strokes without a scene.
void check_strokes(Run& run, const Inputs& strokes, const Input& scene);

/// For every stroke on the object: the rendering weights of the Gaussians under it.
std::vector<ViewSums> stroke_weights_of(const Run& run, const Scene& scene, const Marks& marks,
                                        const GaussianCloud& cloud);

}  // namespace ngs::cli
