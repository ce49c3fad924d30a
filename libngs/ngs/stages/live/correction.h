#pragma once
// What strokes change of a mask: they hold, what they contradict is asked again, and nothing else is touched.
#include "ngs/scene/view_prompt.h"

namespace ngs::live {

/// Strokes hold. Within `contested_px` of those that contradict what the other views say (`prompt`), that is no longer
/// certain: the colours decide. But a stroke on the object takes nothing away, and one beside it adds nothing.
void lay_strokes(const ViewPrompt& strokes, int contested_px, ViewPrompt& prompt);

/// A correction is local: of the mask before it changes what is connected to the new strokes, and to their side.
PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes);

}  // namespace ngs::live
