#pragma once
// Displaces contours to wrong edges of the photo, as segmentation networks do.
#include "ngs/backend/exec.h"
#include "ngs/scene/views.h"

namespace ngs::synth {

/// Copy of an exact label map [H, W] whose contours are snapped to other edges of the photo [H, W, 3]. A contour pixel
/// moves to the strongest edge at a distance of 2 to `reach_px` from the contour if the colour gradient there exceeds
/// kSnapRatio times its own. Displacements are smoothed along the contour. The error depends on the image: unlike a
/// random displacement it is similar in neighbouring views. Without a contour or such an edge the copy is unchanged.
ImageU16 snap_contours(const Exec& exec, const ImageU16& labels, const ImageF& photo, double reach_px);

/// Least gradient of a wrong edge that attracts a contour, relative to the gradient at the contour.
inline constexpr float kSnapRatio = 0.5f;

}  // namespace ngs::synth
