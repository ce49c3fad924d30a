#pragma once
// One Gauss-Newton step of a camera towards its photo: direct image alignment with the depth that the model
// renders.
#include "ngs/scene/camera.h"
#include "ngs/scene/rendered_view.h"

namespace ngs {

/// A small motion of a camera in its own axes: x_cam -> x_cam + turn × x_cam + move.
struct CameraMotion {
  Vec3<double> turn{0, 0, 0};  // rad
  Vec3<double> move{0, 0, 0};  // world units
};

/// The camera after the motion; the rotation stays orthonormal (Rodrigues).
Camera moved(Camera camera, const CameraMotion& motion);

struct PoseStep {
  CameraMotion motion;
  double flow_px = 0;       // RMS over the pixels that count of how far the motion moves the picture
  double total_px = 0;      // the same of so_far and the motion together
  double error = 0;         // mean of log(1 + r² / s²) before the step
  bool determined = false;  // false: no texture, nothing in view
};

inline constexpr double kPoseResidual = 0.05;  // s: residuals above it count less (Cauchy)

/// The picture under a 5x5 binomial: gradients of single pixels mislead.
ImageF smoothed_for_pose(const ImageF& in);

/// `view`: colour, alpha and depth at `camera`; `photo` of the same size. Both are smoothed by a 5x5
/// binomial, and the exposure of the view is laid on the photo's, a gain and an offset per channel. `so_far`:
/// the sum of the motions before this one, which a weak prior keeps small where the photo does not determine
/// them (a turn and a move across the line of sight look alike). Serial.
PoseStep pose_step(const RenderedView& view, const ImageF& photo, const Camera& camera, const CameraMotion& so_far);

}  // namespace ngs
