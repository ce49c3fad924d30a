#pragma once
// What strokes change of a mask: they hold, what is about them is asked again, and nothing else is touched.
#include "ngs/ops/image/grab_cut.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

/// What a view is segmented by when strokes are added to a selection that the person sees.
struct Correction {
  const PixelMask& before;            // the selection
  const ViewPrompt &strokes, &added;  // all of the view, and the new ones of them

  /// Strokes hold. What lies farther than `reach_px` from the new ones, and than `band_px` from the selection's contour
  /// (0: no matter how near), stays as it is.
  ViewPrompt prompt(int reach_px, int band_px) const;
  /// Of each side half those of its strokes and half those of all that is on it: nobody marks every kind of thing that
  /// a picture shows. At most `most` of each half.
  SideColours colours(const ImageU8& picture, int most) const;
};

/// A correction is local: of the mask before it changes what is connected to the new strokes, and to their side.
PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes);

}  // namespace ngs::live
