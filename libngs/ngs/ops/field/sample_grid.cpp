#include "ngs/ops/field/sample_grid.h"

namespace ngs {

BoundaryBox boundary_box(const Camera& camera, Rows<const float, 3> boundary, double pad_px, double world_unit) {
  const RayCamera view = ray_camera(camera, world_unit);
  BoxSums sums;
  for (std::int64_t j = 0; j < boundary.n; ++j) {
    const float* p = boundary.row(j);
    sums.add(view, {double(p[0]), double(p[1]), double(p[2])}, pad_px);
  }
  return boundary_box(view, sums, pad_px);
}

PixelGrid pixel_grid(const PixelBox& box, int rows, int cols) { return pixel_grid(box, GridShape{rows, cols}); }

}  // namespace ngs
