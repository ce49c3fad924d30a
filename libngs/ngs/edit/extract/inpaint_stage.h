#pragma once
// Holes to inpaint after the removal of an object: per view the pixels behind it that no view shows.
#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// A pixel is a hole if the object's weight was at least kMinObjectShare and the remaining seen Gaussians have less
/// opacity than kHoleOpacity.
inline constexpr double kMinObjectShare = 0.05, kHoleOpacity = 0.5;

struct InpaintOptions {
  int inpaint_dilate_px = 8;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.inpaint_dilate_px,
          Field<int>{"inpaint_dilate_px", "px", "Margin by which hole masks are dilated", 0, 4096});
  }
};

/// [N] 1: the Gaussian is visible in some view of the full model (mean weight of at least 0.03 over its pixels).
std::vector<std::uint8_t> seen_gaussians(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud,
                                         const Scene& scene, const SplatOptions& splat);

struct InpaintModel {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& object;  // [N] 1: removed
  const std::vector<std::uint8_t>& seen;    // [N]
  Vec3<float> background{0, 0, 0};
};

struct ViewHole {
  ImageF colour;            // [H, W, 3] render without the object, over the background
  PixelMask hole, dilated;  // [H·W]
};

/// The hole of one view, its dilation, and the render without the object.
ViewHole find_hole(const Exec& exec, const InpaintOptions& options, const InpaintModel& model, const Camera& camera,
                   const SplatOptions& splat);

/// Pixels within `margin_px` (chessboard distance) of the mask.
PixelMask dilated(const PixelMask& mask, int width_px, int height_px, int margin_px);

}  // namespace ngs
