#pragma once
// The strokes of somebody who knows the answer, by a rule that nobody tunes to an object: one along the longest line in
// the middle of it, and one around it.
#include <string>

#include "ngs/scene/hand_prompt.h"

namespace ngs::bench {

/// The object's stroke is the longest line that stays deeper in the mask than a quarter of its deepest place. The
/// background's runs around the mask, 2 % of the diagonal away from it, as far as that is in the picture. A mask
/// without a pixel gives no stroke.
HandPrompt strokes_of_truth(const PixelMask& truth, int width_px, int height_px, const std::string& view);

}  // namespace ngs::bench
