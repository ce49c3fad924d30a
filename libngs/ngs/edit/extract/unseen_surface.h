#pragma once
// The surface of an object that is exposed by its extraction but visible in no view: the underside, the side to a wall.
// The splat is unreliable there: no photo constrains its Gaussians, or they are the inside of the opposite side.
#include "ngs/core/monitor.h"
#include "ngs/math/vectors.h"
#include "ngs/ops/splat/splat.h"
#include "ngs/options/field.h"
#include "ngs/scene/scene.h"
#include "ngs/scene/view_prompt.h"

namespace ngs {

struct UnseenSurface {
  double share = 0;               // unseen fraction of the object's pixels in renders from all directions, in [0, 1]
  double worst = 0;               // this fraction in the direction where it is largest
  orbit::Vec direction{0, 0, 1};  // that direction, from the object to the camera, a unit vector of the world
};

struct UnseenInput {
  const GaussianCloud& cloud;               // the full model of the capture
  const std::vector<std::uint8_t>& object;  // [N] 1: of the extracted object
  const std::vector<Camera>& cameras;       // cameras of the capture
};

/// Renders the object alone from 96 directions spread evenly over the sphere, 96 px wide, framed on its bulk. The
/// surface point of an opaque pixel is seen if it projects into the image of a camera of the capture, its normal (from
/// the render's depths) faces this camera, and the full model's depth there is at most a tenth of the object's radius
/// smaller. The result is 0 if no pixel shows the object.
UnseenSurface unseen_surface(const Exec& exec, Monitor& monitor, const UnseenInput& input);

// Holes to inpaint after the removal of an object: per view the pixels behind it that no view shows.

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
