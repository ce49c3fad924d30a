#pragma once
// The frame in which cameras are placed: its axes belong to the model, so that a turned model has turned cameras.
#include "ngs/stages/orbit/surface_points.h"
#include "ngs/stages/orbit/vectors.h"

namespace ngs::orbit {

struct Frame {
  Vec centre{0, 0, 0};                             // world, relative to the model's origin
  Mat3<double> axes{{1, 0, 0, 0, 1, 0, 0, 0, 1}};  // rows: x and y horizontal, z up; world -> frame

  Vec from_world(Vec p) const { return axes * (p - centre); }
  Vec to_world(Vec p) const { return centre + transpose(axes) * p; }
};

/// The frame about a ball, z along the unit vector `up`, x along the horizontal in which the points within the ball
/// spread most, towards the heavier tail.
Frame frame_about(const SurfacePoints& points, const Ball& ball, Vec up);

/// The direction of up in the world, guessed: from a plane that much of the model lies in, with all but little of the
/// rest on one side, such as a floor or a table top. `found` false: there is no such plane, and up is -y, as the
/// cameras of structure from motion and thereby most models have it.
struct UpGuess {
  Vec up{0, -1, 0};
  bool found = false;
};
UpGuess guess_up(const SurfacePoints& points, const Ball& bulk);

}  // namespace ngs::orbit
