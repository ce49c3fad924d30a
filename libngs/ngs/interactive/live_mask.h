#pragma once
// Interactive segmentation of one image: the cut is found at low resolution and refined to full size in a band around
// its contour. GrabCut of the full image takes seconds.
#include "ngs/ops/image/grab_cut.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

/// `picture`: RGB, of the prompt's size. Certain pixels keep their side; connected components without a certain object
/// pixel are removed. Without any certain object pixel the mask is empty.
PixelMask live_mask(const ImageU8& picture, const ViewPrompt& prompt, std::uint64_t seed);

/// The same with given colour samples.
PixelMask live_mask(const ImageU8& picture, const ViewPrompt& prompt, const SideColours& colours, std::uint64_t seed);

inline constexpr int kColourSamples = 2048;  // per side, for a mixture of five colours

/// If closed background strokes surround all certain object pixels, makes the surrounded pixels likely object and all
/// others background. Otherwise returns false and changes nothing.
bool fill_surrounded(ViewPrompt& prompt);

}  // namespace ngs::live
