#pragma once
// Errors of the opacity of an object, rendered alone: opacity outside its true silhouette (halo) and
// missing inside (holes).
#include <array>
#include <vector>

#include "ngs/ops/image/metrics.h"

namespace ngs {

/// Tolerances of the contour: errors no farther than this from the silhouette's contour are not counted.
inline constexpr std::array<int, 4> kHaloBands_px = {1, 2, 3, 5};
/// Margin around occluders: the silhouette ends there, the object may not.
inline constexpr int kOccluderMargin_px = 4;

/// In px of full opacity per px of contour: the width of an opaque seam of equal area along the contour.
struct OpacityErrors {
  double contour_px = 0;  // silhouette pixels at its contour; 0: the errors are undefined, and 0
  std::array<double, kHaloBands_px.size()> halo_px{}, holes_px{};  // farther outside and inside than each band
};

/// `opacity`: [H, W] in [0, 1]; throws kNumeric for other values. Distances are chessboard distances; the image frame
/// is no contour. Pixels of `occluders` (no data: none) and within kOccluderMargin_px of them are not counted.
OpacityErrors opacity_errors(const std::vector<float>& opacity, MaskPlane silhouette, MaskPlane occluders = {});

}  // namespace ngs
