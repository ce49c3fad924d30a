#pragma once
// Strokes, polygons and boxes of a person as hints at the size that is segmented.
#include <span>

#include "ngs/scene/hand_prompt.h"

namespace ngs {

/// All marks of one view together. Outside of all boxes is certain background, inside likely object; without boxes
/// everything is likely background. All else is certain: strokes cover polygons, these cover painted pixels, and of a
/// kind the later covers the earlier. Marks made on another size are scaled; the shapes must agree within 1 %
/// (kInconsistent).
ViewPrompt rasterise(std::span<const HandPrompt> marks, int width_px, int height_px);
ViewPrompt rasterise(const HandPrompt& prompt, int width_px, int height_px);

}  // namespace ngs
