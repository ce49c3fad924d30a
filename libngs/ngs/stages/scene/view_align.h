#pragma once
// Cameras that are off by a pixel or two. A splat averages over such views, but a mask rendered there misses
// the object's edge by as much. The photo tells: the camera is moved to where the rendered model lies on it.
// PAPER.md §5.11
#include <optional>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/optim/pose_step.h"
#include "ngs/scene/scene.h"
#include "ngs/stages/render/background.h"

namespace ngs {

struct ViewAlignment {
  std::size_t view = 0;
  CameraMotion motion;
  double flow_px = 0;                        // RMS of how far the picture moves, at the working size
  double error_before = 0, error_after = 0;  // pose_step's, both measured on the rendered model
  Camera camera;                             // the moved one
  bool at_rest = false;                      // the first step found less than kSettled_px to move
  bool applied = false;
  std::optional<BackgroundWitness> background;  // of views that were to be questioned, at their camera from now on
};

inline constexpr double kLeastFlow_px = 0.15, kMostFlow_px = 8, kSettled_px = 0.03;
inline constexpr std::size_t kAlignedFirst = 24;

/// The alignment of views with a photo, by index: of all, unless kAlignedFirst of them, evenly spread, and those of
/// `questioned` are all at rest; then the poses are those that the model was fitted with, and the others are left out.
/// Applied: motions of at least kLeastFlow_px that lower the error;
/// larger ones than kMostFlow_px are a wrong pose, not an inaccurate one. What the views of `questioned` say about
/// the background is read off the pictures that the alignment renders.
std::vector<ViewAlignment> measure_alignment(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                                             const std::vector<std::size_t>& questioned = {});

void apply_alignment(const std::vector<ViewAlignment>& alignment, Scene& scene);

}  // namespace ngs
