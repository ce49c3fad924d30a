#pragma once
// The rays of a pixel grid and the query points on them.                                   Eqs. (6)-(7)
//
// Defined for every input: an empty grid has no rays; a window that would cross the camera starts near_z in front of
// it. Positions are in the frame of the given camera (see relative_to).
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/ops/field/ray_query_kernels.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/views.h"

namespace ngs {

/// A rendered depth map of the same camera (RenderedView). If alpha > 0.5 at a ray's pixel, the ray's window is centred
/// on its expected depth, else on mean_distance. Null members: always mean_distance.
struct DepthMap {
  const ImageF* depth = nullptr;  // [H, W, 1] Σ α T z
  const ImageF* alpha = nullptr;  // [H, W, 1]
  const Exec* device = nullptr;   // where the images are; null: on the host
};

struct RayQueries {
  PixelGrid grid;
  int samples = 0;
  std::vector<float> pixel;      // [R, 2] px
  std::vector<float> direction;  // [R, 3] unit
  std::vector<float> near, far;  // [R] sampled part of the ray, world
  std::vector<float> spacing;    // [R] Δ of Eq. (1), world
  std::vector<float> position;   // [R, K, 3] query points, near to far
  std::vector<float> depth;      // [R, K] distance from the camera centre

  std::int64_t rays() const { return std::int64_t(spacing.size()); }
  Rows<const float, 3> positions() const { return {position.data(), rays() * samples}; }
};

RayQueries ray_queries(const Exec& exec, const Camera& camera, const PixelGrid& grid, const RayOptions& options,
                       const DepthMap& map);

/// [R] 1: the view is empty at the node (alpha < 1e-3), or its expected depth lies in the ray's window. Only there
/// rendered colour and field colour belong to the same part of space (C15).
std::vector<std::uint8_t> rays_on_surface(const Camera& camera, const RayQueries& rays, const DepthMap& map);

/// Bilinear sample of channel `c` at a pixel position; clamped to the border.
double sample_bilinear(const ImageF& image, double x_px, double y_px, int c = 0);

}  // namespace ngs
