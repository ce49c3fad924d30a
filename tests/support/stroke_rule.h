#pragma once
// Strokes generated from a true mask by a fixed rule: one along the longest line in the middle of the object, and one
// around the object.
#include <string>

#include "ngs/scene/hand_prompt.h"

namespace ngs::test {

/// Object stroke: the longest line whose pixels are farther from the contour than a quarter of the largest such
/// distance. Background stroke: a loop around the mask at a distance of 2 % of the diagonal, inside the picture. An
/// empty mask gives no strokes.
HandPrompt strokes_of_truth(const PixelMask& truth, int width_px, int height_px, const std::string& view);

}  // namespace ngs::test
