#pragma once
// Cameras that are off by a pixel or two. A splat averages over such views, but a mask rendered there misses
// the object's edge by as much. The photo tells: the shift of the image that lays the rendered model on it is
// given to the camera's principal point, which for small angles is a turn of the camera. PAPER.md §5.11
#include <functional>
#include <vector>

#include "ngs/core/monitor.h"
#include "ngs/ops/splat.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct ViewShift {
  std::size_t view = 0;
  double dx_px = 0, dy_px = 0;               // at the working size
  double error_before = 0, error_after = 0;  // find_shift's, both measured on the rendered model
  bool applied = false;
};

inline constexpr double kLeastShift_px = 0.15, kMostShift_px = 8;

/// The shifts of all views with a photo. Applied: those of at least kLeastShift_px that lower the error when
/// the model is rendered anew at the shifted camera; larger ones than kMostShift_px are a wrong pose, not an
/// inaccurate one.
std::vector<ViewShift> measure_view_shifts(const Exec& exec, Monitor& monitor, const GaussianCloud& cloud,
                                           const Scene& scene,
                                           const std::function<ImageF(std::size_t view)>& load_photo);

void apply_view_shifts(const std::vector<ViewShift>& shifts, Scene& scene);

}  // namespace ngs
