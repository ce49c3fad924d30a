#pragma once
// Gauss-Newton steps of a camera pose towards its photo on one render: direct image alignment with the rendered depth.
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
  double flow_px = 0;       // RMS image displacement by the motion, over the pixels that count
  double total_px = 0;      // the same for so_far and the motion together
  double error = 0;         // mean of log(1 + r² / s²) before the motion
  bool determined = false;  // false: no texture, or nothing in view
};

inline constexpr double kSettled_px = 0.05;    // a step that moves the image by less is the last
inline constexpr double kPoseResidual = 0.05;  // s: scale of the Cauchy weights; larger residuals count less

/// The image, smoothed by a 5x5 binomial filter: gradients of single pixels are too noisy.
ImageF smoothed_for_pose(const ImageF& in);

/// `view`: colour, alpha and depth at `camera`. `photo`: of the same size, already smoothed by smoothed_for_pose(). The
/// colour of the view is smoothed here, and its exposure is matched to the photo by a gain and an offset per channel.
/// Steps after the first compare each pixel with the point of the photo that it has moved to, not with another render.
/// `so_far`: the sum of the previous motions, which a weak prior keeps small where the photo does not determine them (a
/// turn and a move across the line of sight look alike). Every `pixel_step`-th column and row counts. Serial.
PoseStep pose_step(const RenderedView& view, const ImageF& photo, const Camera& camera, const CameraMotion& so_far,
                   int pixel_step = 1);

}  // namespace ngs
