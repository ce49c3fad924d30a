#pragma once
// Places cameras for a model without photos so that they cover its surface, from outside or, for a room, from inside.
//
// Candidates are rings of cameras around the bulk of the model or a given ball. A grid of the model's extinction limits
// their distance to free lines of sight. The visibility from each candidate is rendered at low resolution. Cameras are
// then added greedily, each time the one that adds most surface shown by fewer than three, until the surface is
// covered. The result rotates, moves and scales with the model if the up axis does.
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/core/monitor.h"
#include "ngs/orbit/orbit_options.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::orbit {

struct OrbitCameras {
  std::vector<Camera> cameras;  // named 0000.png, 0001.png ..., the initial rings first
  Vec centre{0, 0, 0};          // world, origin included: the point that cameras look at, or the middle of the room
  double radius = 0;            // world
  Vec up{0, -1, 0};             // world, unit length
  bool up_is_guessed = false;   // estimated from a floor of the model
  bool inside = false;          // the cameras are inside the model
  double coverage = 0;          // fraction of the visible surface that at least kWantedViews cameras show
  std::size_t candidates = 0;   // number of candidate cameras
  std::size_t surface = 0;      // number of Gaussians of the visible surface
  double world_unit = 1;        // below 1 if 3DGS's near plane would cut into the model (math/world_unit.h)
};

struct PictureSize {
  int width_px = 0, height_px = 0;
};

/// Parses "X,Y,Z,R" with finite numbers and R > 0; throws kUsage otherwise.
Ball parse_ball(const std::string& text);

/// The axis as a unit vector; -y for kAuto.
Vec axis_of(UpAxis up);

/// The cameras for images of `size`.
///
/// Throws kNothingFound if no Gaussian is visible, if none lies in the ball, or if no camera around the ball has a free
/// line of sight; kUsage for `options`.
OrbitCameras choose_cameras(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const OrbitOptions& options,
                            PictureSize size);

/// The same figures for given cameras, whose names and poses are kept: up is their mean, world_unit is 1. Throws
/// kNothingFound if no Gaussian is visible, or if none lies in the ball.
OrbitCameras assess_cameras(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const OrbitOptions& options,
                            std::vector<Camera> cameras);

}  // namespace ngs::orbit
