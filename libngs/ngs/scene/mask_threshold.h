#pragma once
// Where a share in [0, 1] becomes a decision. Three rules, because exactly one half is a value of its own:
//
//   a mask that was given        1/2 is the object's: a soft mask says so, and so does the mean of four pixels of which
//   two are a label, and a mask that     1/2 is not: it is where labels begin, and what is between object and
//   background was rendered or refined a flag, a share that is known  1/2 counts: columns of a PLY hold 0 or 1, and
//   half a pixel's evidence is evidence
#include "ngs/core/hd.h"

namespace ngs {

inline constexpr float kHalfShare = 0.5f;

/// Whether a given mask says that the pixel is the object's.
NGS_HD inline bool mask_is_foreground(float mask) { return mask >= kHalfShare; }

/// Whether a label, or a mask rendered from labels, says object.
NGS_HD inline bool label_is_foreground(float label) { return label > kHalfShare; }

/// Whether a 0/1 column, or the share of a pixel of which something is known, says yes.
NGS_HD inline bool is_set(float flag) { return flag >= kHalfShare; }

}  // namespace ngs
