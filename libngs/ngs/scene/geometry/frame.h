#pragma once
// The coordinate frame in which cameras are placed. Its axes follow the model, so that cameras rotate with the model.
#include "ngs/math/vectors.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::orbit {

struct Frame {
  Vec centre{0, 0, 0};                             // world, relative to the model's origin
  Mat3<double> axes{{1, 0, 0, 0, 1, 0, 0, 0, 1}};  // rows: x and y horizontal, z up; world -> frame

  Vec from_world(Vec p) const { return axes * (p - centre); }
  Vec to_world(Vec p) const { return centre + transpose(axes) * p; }
};

/// The frame centred on a ball, z along the unit vector `up`, x along the horizontal direction in which the points
/// within the ball have the largest variance, with the sign of their skewness.
Frame frame_about(const SurfacePoints& points, const Ball& ball, Vec up);

/// The estimated up direction of the world: the normal of a plane that contains much of the model, such as a floor or a
/// table top, with nearly all of the rest on one side. Without such a plane, or if an object that is alone clearly
/// stands on another side (stance.h), up is the axis on which that object stands. Otherwise `found` is false and up is
/// -y, as in most models from structure from motion.
struct UpGuess {
  Vec up{0, -1, 0};
  bool found = false;
};
UpGuess guess_up(const SurfacePoints& points, const Ball& bulk);

}  // namespace ngs::orbit
