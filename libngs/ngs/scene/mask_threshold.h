#pragma once
// Thresholds of shares in [0, 1]. There are three rules because exactly 1/2 occurs as a value:
//
// clang-format off
//   input                                      1/2 is        why
//   a given mask                               foreground    soft masks: the mean of four pixels, two of them object
//   a label, a rendered or refined mask        background    labels start at 1/2: undecided
//   a flag, the known share of a pixel         set           PLY columns hold 0 or 1; half a pixel's evidence counts
// clang-format on
#include "ngs/core/hd.h"

namespace ngs {

inline constexpr float kHalfShare = 0.5f;
/// Samples of a mask file, of 255: object at and above this value, in imports and in evaluation.
inline constexpr double kMaskThreshold = 128;

/// Whether a pixel of a given mask is object.
NGS_HD inline bool mask_is_foreground(float mask) { return mask >= kHalfShare; }

/// Whether a label, or a pixel of a rendered or refined mask, is object.
NGS_HD inline bool label_is_foreground(float label) { return label > kHalfShare; }

/// Whether a 0/1 column, or the known share of a pixel, counts as set.
NGS_HD inline bool is_set(float flag) { return flag >= kHalfShare; }

}  // namespace ngs
