#pragma once
// Which way up an object stands that is alone in its model, without a floor, and the ball around all of it.
//
// What an object stands on is wide, ends sharply in a plane, often a hole that no view saw, and the opposite end is
// not like that. Most objects are higher than wide.
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::orbit {

/// How much better the object stands on its end towards -up than on the other, in [-2.6, 2.6]; 0 if that end is no
/// base: narrow, round or ragged.
double stance(const SurfacePoints& points, Vec up);

/// The axis of the model, of six, with the best stance; -y, the up of most models from structure from motion, if no
/// other is clearly better. The value is 0 if the model has far surroundings.
inline constexpr double kClear = 0.1;  // the least stance() that is evidence
struct Stance {
  Vec up{0, -1, 0};
  double value = 0;  // stance() of it
  bool is_clear() const { return value >= kClear; }
};
Stance best_stance(const SurfacePoints& points, const Ball& bulk);

/// Whether the model has no surroundings about `centre`: these reach far, with large Gaussians.
bool is_alone(const SurfacePoints& points, Vec centre);

/// The ball to frame: around all points of an object that stands alone, such as a tall one that reaches out of `bulk`;
/// else `bulk`. It rotates with the points and `up`.
Ball ball_to_frame(const SurfacePoints& points, const Ball& bulk, Vec up);

}  // namespace ngs::orbit
