#pragma once
// Strokes and boxes of a person as hints at the size that is segmented.
#include "ngs/scene/hand_prompt.h"

namespace ngs {

/// Outside of all boxes is certain background, inside likely object; without boxes everything is likely
/// background. Strokes are certain; a later one covers an earlier one, all cover painted pixels. Another size
/// is scaled; the shapes must agree within 1 % (kInconsistent).
ViewPrompt rasterise(const HandPrompt& prompt, int width_px, int height_px);

}  // namespace ngs
