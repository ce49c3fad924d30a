#pragma once
// What is left to invent once an object is taken out: per view the pixels behind it that no view has seen.
#include "ngs/core/monitor.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

/// A pixel is a hole where the object had at least the first share of it, and what is left and was seen is less opaque
/// than the second.
inline constexpr double kLeastObjectShare = 0.05, kHoleOpacity = 0.5;

struct InpaintOptions {
  int inpaint_dilate_px = 8;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.inpaint_dilate_px,
          Field<int>{"inpaint_dilate_px", "px", "Margin by which hole masks are dilated", 0, 4096});
  }
};

/// [N] 1: some view sees the Gaussian in the whole model (its mean weight over the pixels it reaches is at
/// least 0.03).
std::vector<std::uint8_t> seen_gaussians(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud,
                                         const Scene& scene, const SplatOptions& splat);

struct InpaintModel {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& object;  // [N] 1: taken out
  const std::vector<std::uint8_t>& seen;    // [N]
  Vec3<float> background{0, 0, 0};
};

struct ViewHole {
  ImageF colour;            // [H, W, 3] what is left, over the background
  PixelMask hole, dilated;  // [H·W]
};

/// Holes of one view: the object's share of the pixel was at least kLeastObjectShare, and the seen Gaussians of
/// what is left reach less than kHoleOpacity there.
ViewHole find_hole(const Exec& exec, const InpaintOptions& options, const InpaintModel& model, const Camera& camera,
                   const SplatOptions& splat);

/// Pixels within `margin_px` (chessboard distance) of the mask.
PixelMask dilated(const PixelMask& mask, int width_px, int height_px, int margin_px);

}  // namespace ngs
