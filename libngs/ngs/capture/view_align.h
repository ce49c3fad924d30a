#pragma once
// Corrects camera poses that are off by a pixel or two. A splat averages over such views, but a mask rendered there
// misses the object's contour by as much. Each camera is moved so that the rendered model aligns with its photo.
// paper.md §5.11
#include <optional>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/optim/pose_step.h"
#include "ngs/render/background.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct ViewAlignment {
  std::size_t view = 0;
  CameraMotion motion;
  double flow_px = 0;                        // RMS motion of the image in pixels of the working size
  double error_before = 0, error_after = 0;  // error of pose_step, both measured on the rendered model
  Camera camera;                             // the moved camera
  bool at_rest = false;                      // the first render shows a motion below kMinFlow_px
  bool applied = false;
  std::optional<BackgroundMeasurement> background;  // of `background_views`, at the camera after alignment
};

inline constexpr double kMinFlow_px = 0.15, kMaxFlow_px = 8;
inline constexpr std::size_t kAlignedFirst = 24;

/// The alignment of views with a photo, by index. First kAlignedFirst evenly spread views and `background_views` are
/// aligned. If all of these are at rest, the poses are those of the fit and the other views are left out. Motions of
/// at least kMinFlow_px that lower the error of a render are applied; motions above kMaxFlow_px are not, they indicate
/// a wrong pose rather than an inaccurate one. For `background_views` the background is measured on the renders of the
/// alignment.
std::vector<ViewAlignment> measure_alignment(const Exec& exec, Monitor& monitor, const PhotographedModel& model,
                                             const std::vector<std::size_t>& background_views = {});

void apply_alignment(const std::vector<ViewAlignment>& alignment, Scene& scene);

}  // namespace ngs
