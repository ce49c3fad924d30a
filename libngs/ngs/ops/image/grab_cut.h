#pragma once
// GrabCut (Rother, Kolmogorov, Blake 2004) by OpenCV: a colour mixture per side and a minimum cut, within
// hints. The colours of both sides are learnt from the certain pixels before the first cut, so that what is
// only likely cannot spoil them. One thread and a fixed seed: the same bytes everywhere.
#include <array>

#include "ngs/scene/view_prompt.h"

namespace ngs {

struct GrabCutOptions {
  int iterations = 3;  // cuts; after the first the colours are learnt again from its result
  int margin_px = 40;  // only this much around the pixels that are not certain background is looked at
  std::uint64_t seed = 0;
};

/// `photo` RGB of the prompt's size. Certain pixels keep their side. Where one side has fewer than 5 pixels
/// of any kind there is nothing to learn from: the likely sides come back as they are.
PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options);

/// Colours that are known to be of one side or the other.
struct SideColours {
  std::vector<std::array<std::uint8_t, 3>> object, background;  // RGB
};

/// Of the certain pixels, or of all of a side that has fewer than 5 of these; at most `most` per side, evenly chosen.
SideColours side_colours(const ImageU8& photo, const ViewPrompt& prompt, int most);

/// The same cut, begun with these colours: those of the large picture for a small one of it.
PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options,
                   const SideColours& colours);

}  // namespace ngs
