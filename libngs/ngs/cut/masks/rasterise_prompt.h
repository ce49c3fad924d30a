#pragma once
// Rasterises hand-drawn strokes, polygons and boxes to hints at the segmented size.
#include <span>

#include "ngs/scene/hand_prompt.h"

namespace ngs {

/// All marks of one view together. With boxes, pixels outside all boxes are certain background and pixels inside likely
/// object; without boxes everything is likely background. Other marks are certain: strokes override polygons, polygons
/// override painted pixels, and later marks of a kind override earlier ones. Marks made at another size are scaled.
/// Throws kInconsistent if the aspect ratios differ by more than 1 %.
ViewPrompt rasterise(std::span<const HandPrompt> marks, int width_px, int height_px);
ViewPrompt rasterise(const HandPrompt& prompt, int width_px, int height_px);

}  // namespace ngs
