#pragma once
// Local correction of a mask by strokes: pixels under strokes are fixed, pixels near them are segmented again, all
// others stay.
#include "ngs/ops/image/grab_cut.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

/// Input of the segmentation when strokes are added to a visible selection.
struct Correction {
  const PixelMask& before;            // the selection
  const ViewPrompt &strokes, &added;  // all strokes of the view, and the new ones among them

  /// Hints: certain under strokes. Pixels farther than `reach_px` from the new strokes and than `band_px` from the
  /// selection's contour keep their side; `band_px` 0: no band. Without a stroke on the object, the half of the
  /// selection that is farther from the new strokes keeps its side: it shows the object's colours and place.
  ViewPrompt prompt(int reach_px, int band_px) const;
  /// Colour samples of each side: half from its strokes and half from all its pixels, because strokes do not cover
  /// every colour of an image. At most `max_samples` per half.
  SideColours colours(const ImageU8& picture, int max_samples) const;
};

/// Applies to `before` only the changes in `found` that are connected to the new strokes, and towards their side.
PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes);

}  // namespace ngs::live
