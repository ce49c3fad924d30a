#pragma once
// How Gaussians are projected and composited (ops/splat/splat.h).                         Eq. (2)
#include <memory>

#include "ngs/scene/compat.h"

namespace ngs {

/// The view-independent part of projection, computed once for many views (splat.h: prepare_cloud).
class PreparedCloud;

/// Camera z of the near plane in units of SplatOptions::world_unit.                            paper.md §5.1
constexpr double near_plane(Compat compat) { return compat == Compat::kInria ? 0.2 : 0.01; }

struct SplatOptions {
  Compat compat = Compat::kInria;
  bool antialiased = false;  // multiply opacity by sqrt(det / det_blurred)
  int max_sh_degree = 3;     // bands above it are not evaluated
  double blur_px2 = 0.3;     // variance of the low-pass filter at the rendered size; see filter_at_scale
  double world_unit = 1;     // math/world_unit.h
  std::shared_ptr<const PreparedCloud> prepared = nullptr;  // used only for the cloud that it was made from; null: none
};

/// The options for an image `scale` times the size that the model was fitted at: the same filter in the scene, so
/// scale² times the variance in pixels. With an unscaled 0.3 px² at a larger size, footprints shrink and rendered masks
/// become too small.
inline SplatOptions filter_at_scale(SplatOptions options, double scale) {
  options.blur_px2 *= scale * scale;
  return options;
}

}  // namespace ngs
