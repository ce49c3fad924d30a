#pragma once
// The mask of one picture while a person waits: the cut is found small, and followed to the full size in a band about
// its contour. GrabCut of the whole picture takes seconds.
#include "ngs/ops/image/grab_cut.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

/// `picture` RGB of the prompt's size. Certain pixels keep their side; pieces without a certain pixel of the object are
/// removed. Where nothing is certainly the object the mask is empty.
PixelMask live_mask(const ImageU8& picture, const ViewPrompt& prompt, std::uint64_t seed);

/// The same by colours that are known.
PixelMask live_mask(const ImageU8& picture, const ViewPrompt& prompt, const SideColours& colours, std::uint64_t seed);

inline constexpr int kColourSamples = 2048;  // per side, for a mixture of five colours

/// A person who draws a line of background all around a thing says that it lies within: what the line surrounds becomes
/// likely object, everything else background. False, and nothing changes, where no such line surrounds all pixels that
/// are certainly the object.
bool fill_surrounded(ViewPrompt& prompt);

}  // namespace ngs::live
