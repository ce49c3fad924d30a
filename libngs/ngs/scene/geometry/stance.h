#pragma once
// Estimates which way is up for an object without a floor that is alone in its model, and a ball around it.
//
// A base is wide and ends sharply in a plane, often a hole that no view saw; the opposite end does not. Most objects
// are taller than wide.
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::orbit {

/// Score of the end towards -up as the object's base, minus the score of the opposite end, in [-2.6, 2.6]. 0 if the end
/// towards -up is no base: narrow, round or ragged.
double stance(const SurfacePoints& points, Vec up);

/// The one of six axis directions with the best stance(). If none is clearly better, it is -y, which is up in most
/// models from structure from motion. The value is 0 if the model has far surroundings.
inline constexpr double kClear = 0.1;  // the least stance() that is evidence
struct Stance {
  Vec up{0, -1, 0};
  double value = 0;  // stance() of it
  bool is_clear() const { return value >= kClear; }
};
Stance best_stance(const SurfacePoints& points, const Ball& bulk);

/// Whether the model has no surroundings about `centre`. Surroundings reach far and consist of large Gaussians.
bool is_alone(const SurfacePoints& points, Vec centre);

/// The ball that a camera should frame: around all points of an object without surroundings, such as a tall one that
/// extends beyond `bulk`; otherwise `bulk`. The ball rotates with the points and `up`.
Ball ball_to_frame(const SurfacePoints& points, const Ball& bulk, Vec up);

}  // namespace ngs::orbit
