#pragma once
// Cameras for a model that comes without photos: chosen so that its surface is seen, from outside or, where it is a
// room, from within.
//
// The bulk of the model (or the ball that is named) is looked at from rings of cameras. A grid of the model's
// extinction says how far away a camera can stand with a free line of sight. What each place would see is rendered
// small; then cameras are added, always the one that shows most of what fewer than three show, until the surface is
// covered. All of it turns, moves and scales with the model where the axis of up does.
#include <string>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/core/monitor.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/compat.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/stages/orbit/orbit_options.h"
#include "ngs/stages/orbit/surface_points.h"

namespace ngs::orbit {

struct OrbitCameras {
  std::vector<Camera> cameras;     // named 0000.png, 0001.png ..., those to begin with first
  Vec centre{0, 0, 0};             // world, origin included: what they look at, or the middle of the room
  double radius = 0;               // world
  Vec up{0, -1, 0};                // world, unit length
  bool up_is_guessed = false;      // by a floor of the model's
  bool inside = false;             // they stand in the model
  double coverage = 0;             // share of the visible surface that at least kWantedViews of them show
  std::size_t candidates = 0;      // places that were looked from
  std::size_t surface = 0;         // Gaussians of the visible surface
  Compat compat = Compat::kInria;  // gsplat where Inria's near plane would cut into the model
};

struct PictureSize {
  int width_px = 0, height_px = 0;
};

/// "X,Y,Z,R" with finite numbers and R > 0; kUsage otherwise.
Ball parse_ball(const std::string& text);

/// The axis as a unit vector; -y for kAuto.
Vec axis_of(UpAxis up);

/// The cameras for pictures of `size`.
///
/// Errors: kNothingFound where no Gaussian can be seen, none lies in the ball, or no place about it has a free line of
/// sight; kBadInput where the model is so small that a renderer's near plane would hide it; kUsage for `options`.
OrbitCameras choose_cameras(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud, const OrbitOptions& options,
                            PictureSize size);

}  // namespace ngs::orbit
