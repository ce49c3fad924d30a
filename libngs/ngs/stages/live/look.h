#pragma once
// Where a person stands before a model and how they look at it, and where to begin with a model that is new to them.
#include "ngs/backend/exec.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/compat.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::live {

/// A camera as a person steers it. Square pixels, the principal point in the middle of the picture.
struct Look {
  Vec3<double> position{0, 0, 0}, look_at{0, 0, 1}, up{0, -1, 0};  // world
  double fov_y_deg = 50;                                           // over the height, in (0, 180)
  int width_px = 640, height_px = 480;
};

/// To the last digit.
bool operator==(const Look& a, const Look& b);

/// kUsage where `position` and `look_at` are one point. Where `up` lies along the line of sight, any other is taken.
Camera camera_of(const Look& look);

/// What of a model there is to look at, and from where first: outside, or from within where it is a room.
struct FirstLook {
  Vec3<double> centre{0, 0, 0};  // world
  double radius = 0;             // world, > 0
  Vec3<double> up{0, -1, 0};     // unit length
  Look look;
  Compat compat = Compat::kInria;  // gsplat where Inria's near plane would cut into what is looked at
};

/// kNothingFound where no Gaussian can be seen.
FirstLook first_look(const Exec& exec, const GaussianCloud& cloud);

}  // namespace ngs::live
