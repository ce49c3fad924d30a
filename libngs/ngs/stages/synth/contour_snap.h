#pragma once
// Contours displaced to wrong edges of the photo, as segmentation networks displace them.
#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs::synth {

/// Copy of an exact label map [H, W] whose contours snap to edges of the photo [H, W, 3] that are not theirs. A contour
/// pixel moves to the strongest edge from 2 to `reach_px` away from the contour if the colour gradient there exceeds
/// kSnapRatio of its own; displacements are smoothed along the contour. The error follows the picture: it is the same
/// in neighbouring views, unlike a random displacement. Returns the copy unchanged without a contour or such an edge.
ImageU16 snap_contours(const Exec& exec, const ImageU16& labels, const ImageF& photo, double reach_px);

/// A wrong edge attracts a contour from this share of the gradient at the contour on.
inline constexpr float kSnapRatio = 0.5f;

}  // namespace ngs::synth
