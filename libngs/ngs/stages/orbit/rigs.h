#pragma once
// Places for cameras: rings about a ball, as far as there is free space; or stands within a room.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/camera.h"
#include "ngs/stages/orbit/frame.h"
#include "ngs/stages/orbit/free_space.h"

namespace ngs::orbit {

/// What all cameras of a rig have in common.
struct Lens {
  int width_px = 0, height_px = 0;
  double fov_deg = 40;  // over the longer side

  double focal_px() const;
  /// Sine of half the angle over the shorter side.
  double least_half_sine() const;
};

/// A place for a camera, in the frame.
struct Pose {
  Vec centre{0, 0, 0}, target{0, 0, 0};
};

/// The camera at `pose` with the frame's z upwards in its picture (its x where it looks along z). Coordinates of the
/// camera are those of the world, `origin` included.
Camera camera_at(const Pose& pose, const Lens& lens, const Frame& frame, const std::array<double, 3>& origin);

/// Cameras about the ball of `radius` at the frame's centre, each as far away as lets the ball fill the shorter side,
/// nearer where something stands in the way, and left out where it would have to come nearer than 0.6 of that.
/// `first` of them are the rings to begin with: low, middle and high above the horizontal; the others lie between,
/// above and below.
struct Rig {
  std::vector<Pose> poses;
  std::size_t first = 0;
};
Rig rings_about(double radius, const Lens& lens, const FreeSpace& space, int views);

/// How much a model shows from within, and how much to those who walk about it. Openings above do not make an object of
/// a room: who looks in through them is not counted.
struct RoomFinding {
  std::vector<Vec> stands;  // free places that the model surrounds, far from one another and from all mass
  double seen_inside = 0;   // cells that stop rays from the stands
  double only_inside = 0;   // of these, those that are no side of what stops level rays from outside
  double only_outside = 0;  // cells that stop such rays and are no side of what is seen from the stands
  /// Places surround, and show what is not seen from outside: more than is seen only there, by 2 % of all.
  bool is_room() const { return !stands.empty() && only_inside > only_outside + 0.02 * seen_inside; }
};
RoomFinding find_room(const Exec& exec, const FreeSpace& space, double radius);

/// Cameras at the stands, looking all around, level, up and down. None of them comes first.
Rig cameras_within(const std::vector<Vec>& stands, double radius);

}  // namespace ngs::orbit
