#pragma once
// What strokes change of a mask: they hold, what they contradict is asked again, and nothing else is touched.
#include "ngs/ops/image/grab_cut.h"
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

/// Strokes hold. Within `contested_px` of those that contradict what the other views say (`prompt`), that is no longer
/// certain: the colours decide. But a stroke on the object takes nothing away, and one beside it adds nothing.
void lay_strokes(const ViewPrompt& strokes, int contested_px, ViewPrompt& prompt);

/// What a view with a mask is segmented by when strokes are added to those that it has.
struct Correction {
  const PixelMask& before;
  const ViewPrompt &strokes, &added;  // all of the view, and the new ones of them

  /// Strokes hold, and what lies farther than `reach_px` from the new ones stays as it is.
  ViewPrompt prompt(int reach_px) const;
  /// Of the object those of its strokes; of the background those of its strokes and, as many, of all that was not
  /// selected: nobody marks every kind of thing that a picture shows. At most `most` per side.
  SideColours colours(const ImageU8& picture, int most) const;
};

/// A correction is local: of the mask before it changes what is connected to the new strokes, and to their side.
PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes);

}  // namespace ngs::live
