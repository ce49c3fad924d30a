#pragma once
// The interactive camera, and an initial view of a new model.
#include "ngs/backend/exec.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::live {

/// An interactive camera. Square pixels, the principal point in the middle of the image.
struct Viewpoint {
  Vec3<double> position{0, 0, 0}, look_at{0, 0, 1}, up{0, -1, 0};  // world
  double fov_y_deg = 50;                                           // over the height, in (0, 180)
  int width_px = 640, height_px = 480;
};

bool operator==(const Viewpoint& a, const Viewpoint& b);

/// Exact equality of position, look_at and up: pictures of one view, perhaps in windows of different sizes.
bool has_same_pose(const Viewpoint& a, const Viewpoint& b);

/// Throws kUsage if `position` equals `look_at`. If `up` is parallel to the line of sight, any perpendicular is used.
Camera camera_of(const Viewpoint& viewpoint);

/// The bulk of a model and an initial view of it: from outside, or from inside for a room.
struct InitialViewpoint {
  Vec3<double> centre{0, 0, 0};  // world
  double radius = 0;             // world, > 0
  Vec3<double> up{0, -1, 0};     // unit length
  Viewpoint viewpoint;
  double world_unit = 1;  // below 1 if 3DGS's near plane would cut into the bulk (math/world_unit.h)
};

/// Throws kNothingFound if no Gaussian is visible.
InitialViewpoint initial_viewpoint(const Exec& exec, const GaussianCloud& cloud);

}  // namespace ngs::live
