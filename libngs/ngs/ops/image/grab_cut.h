#pragma once
// GrabCut (Rother, Kolmogorov, Blake 2004) of OpenCV: a colour mixture per side and a minimum cut, with hints per
// pixel. The colours of both sides are learned from certain pixels before the first cut, so likely pixels cannot
// distort them. One thread and a fixed seed: the same bytes everywhere.
#include "ngs/ops/image/colour_cut.h"

namespace ngs {

struct GrabCutOptions {
  int iterations = 3;  // number of cuts; each after the first learns the colours from the previous result
  int margin_px = 40;  // margin of the processed region around all pixels that are not certain background
  std::uint64_t seed = 0;
};

/// `photo` RGB of the prompt's size. Certain pixels keep their side. If one side has fewer than 5 pixels in all, no
/// colours can be learned: likely pixels keep their side too.
PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options);

/// Colours of the certain pixels; of all pixels of a side that has fewer than 5 certain ones. At most `max_samples` per
/// side, evenly sampled.
SideColours side_colours(const ImageU8& photo, const ViewPrompt& prompt, int max_samples);

/// The same cut, starting with these colours, for example those of the full-size image for a downscaled one.
PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options,
                   const SideColours& colours);

}  // namespace ngs
