#pragma once
// Candidate camera poses: rings around a ball, as far as there is free space, or viewpoints inside a room.
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/orbit/free_space.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/geometry/frame.h"

namespace ngs::orbit {

/// The intrinsics of all cameras of a rig.
struct Intrinsics {
  int width_px = 0, height_px = 0;
  double fov_deg = 40;  // over the longer side

  double focal_px() const;
  /// Sine of half the angle over the shorter side.
  double least_half_sine() const;
};

/// A camera pose in frame coordinates.
struct Pose {
  Vec centre{0, 0, 0}, target{0, 0, 0};
};

/// The camera at `pose` with the frame's z upwards in its image, or the frame's x if it looks along z. The camera is in
/// world coordinates, `origin` included.
Camera camera_at(const Pose& pose, const Intrinsics& intrinsics, const Frame& frame,
                 const std::array<double, 3>& origin);

/// Cameras around the ball of `radius` at the frame's centre. At the full distance the ball fills the shorter side of
/// the image. A camera with an obstacle in front is moved nearer, and left out below 0.6 of the full distance. The
/// first `first` poses are the initial rings: low, middle and high above the horizontal; the others lie between, above
/// and below.
struct Rig {
  std::vector<Pose> poses;
  std::size_t first = 0;
};
Rig rings_about(double radius, const Intrinsics& intrinsics, const FreeSpace& space, int views);

/// Cameras above each target that look at it, from `distance` or as far as the line of sight is free, at least from
/// 0.6 of it. `first` is 0.
Rig cameras_above(const std::vector<Vec>& targets, double distance, const FreeSpace& space);

/// Surface visible from inside the model compared with the surface visible from outside. Views from above are not used:
/// an open ceiling does not make a room an object.
struct RoomFinding {
  std::vector<Vec> viewpoints;  // free points that the model surrounds, far from one another and from all mass
  double seen_inside = 0;       // cells that stop rays from the viewpoints
  double only_inside = 0;       // of these, cells not within a wall that stops level rays from outside
  double only_outside = 0;      // cells that stop level rays from outside and are not within a wall seen from inside
  /// There are viewpoints, and only_inside exceeds only_outside by more than 2 % of seen_inside.
  bool is_room() const { return !viewpoints.empty() && only_inside > only_outside + 0.02 * seen_inside; }
};
RoomFinding find_room(const Exec& exec, const FreeSpace& space, double radius);

/// Cameras at the viewpoints, looking all around, level, up and down. `first` is 0.
Rig cameras_within(const std::vector<Vec>& viewpoints, double radius);

}  // namespace ngs::orbit
