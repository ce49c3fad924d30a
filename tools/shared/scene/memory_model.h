#pragma once
// What the tools' --dry-run counts alike: bytes that a model and a pass over one of its views take.
#include <algorithm>
#include <cmath>

#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/scene.h"

namespace ngs::cli {

inline constexpr double kMib = 1024.0 * 1024.0, kProgramMib = 48;
/// What the projection takes from a Gaussian alone.
inline constexpr double kPreparedBytes = 60;
/// Tiles that a Gaussian reaches, at most in the mean.
inline constexpr double kTilesReached = 3;
/// Of a visible Gaussian: id, record, depth, rectangle, first span, first slot and a flag; spans, whose lists grow by
/// doubling.
inline constexpr double kVisibleBytes = 4 + 56 + 4 + 16 + 8 + 8 + 1 + 2 * kTilesReached * 8;

/// Position, rotation, scale, opacity, bands, usable.
inline double model_bytes(const GaussianCloud& cloud) { return 57 + 12.0 * cloud.rest_count(); }

/// Label columns of a Gaussian that is part of `owners` objects.
inline double label_bytes(double owners) { return 20 * (owners + 1); }

inline double view_px(const SceneView& view) { return double(view.camera.width_px) * view.camera.height_px; }

inline double largest_view_px(const Scene& scene) {
  double largest = 0;
  for (const SceneView& view : scene.views) largest = std::max(largest, view_px(view));
  return largest;
}

/// Of all that was counted, with the program itself.
inline double peak_mib(double bytes) { return std::ceil(bytes / kMib + kProgramMib); }

}  // namespace ngs::cli
