#pragma once
// How Gaussians are projected and composited (ops/splat/splat.h).                         Eq. (2)
#include <memory>

#include "ngs/scene/compat.h"

namespace ngs {

/// What the projection takes from the Gaussians of a model alone, worked out once for many views.
class PreparedCloud;

/// How near to a camera something is still drawn, in world units along the camera's axis.       PAPER.md §5.1
constexpr double near_plane(Compat compat) { return compat == Compat::kInria ? 0.2 : 0.01; }

struct SplatOptions {
  Compat compat = Compat::kInria;
  bool antialiased = false;  // multiply opacity by sqrt(det / det_blurred)
  int max_sh_degree = 3;     // bands above it are not evaluated
  double blur_px2 = 0.3;     // variance of the low-pass filter at the rendered size; see filter_at_scale
  std::shared_ptr<const PreparedCloud> prepared = nullptr;  // used for the cloud that it was made from; null: none
};

/// The options for a picture `scale` times the size the model was fitted at: the same filter in the scene, that is
/// scale² times its variance in pixels. With the 0.3 px² of the fitting size at a larger size, footprints shrink and
/// rendered masks come out too small.
inline SplatOptions filter_at_scale(SplatOptions options, double scale) {
  options.blur_px2 *= scale * scale;
  return options;
}

}  // namespace ngs
