#pragma once
// What the opacity of an object, rendered alone, has beside its true silhouette (halo) and lacks within it (holes).
#include <array>
#include <vector>

#include "ngs/ops/image/metrics.h"

namespace ngs {

/// What lies no farther than this from the silhouette's contour is left out: a contour may be so inexact.
inline constexpr std::array<int, 4> kHaloBands_px = {1, 2, 3, 5};
/// Of what stands before the object: the silhouette ends there, the object need not.
inline constexpr int kOccluderMargin_px = 4;

/// In px of full opacity per px of contour: the width of an opaque seam along the contour that would be as much.
struct OpacityErrors {
  double contour_px = 0;  // silhouette pixels beside others; 0: nothing else is defined, and 0
  std::array<double, kHaloBands_px.size()> halo_px{}, holes_px{};  // farther outside, and inside, than the bands
};

/// `opacity`: [H, W] in [0, 1]; throws kNumeric for other values. Distances are chessboard distances; the picture's
/// frame is no contour. `occluders` (no data: none) and what is within kOccluderMargin_px of them count nowhere.
OpacityErrors opacity_errors(const std::vector<float>& opacity, MaskPlane silhouette, MaskPlane occluders = {});

}  // namespace ngs
