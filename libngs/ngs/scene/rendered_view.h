#pragma once
// The rendered images of one camera, and ∂L/∂ of them.
#include <vector>

#include "ngs/scene/views.h"

namespace ngs {

/// Alpha-composited channels of one view. Images that were not requested are empty.
struct RenderedView {
  int width_px = 0, height_px = 0;
  ImageF colour;  // [H, W, 3] linear in the model's colour space, background included
  ImageF label;   // [H, W, K] Σ α T m, no background
  ImageF alpha;   // [H, W, 1] 1 - T_final
  ImageF depth;   // [H, W, 1] Σ α T z (camera z, world units); expected depth = depth / alpha
};

/// ∂L/∂(each image of RenderedView), same shapes; empty = zero.
struct ViewGradients {
  ImageF colour, label, alpha, depth;
  // Whether the channel's gradient flows to geometry and opacity (∂L/∂α), or only to the channel's own values.
  bool colour_moves_geometry = true;
  bool label_moves_geometry = false;  // COB-GS: never; --effect mask-geometry: yes
  bool depth_moves_geometry = true;
};

}  // namespace ngs
