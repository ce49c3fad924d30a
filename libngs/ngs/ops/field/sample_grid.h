#pragma once
// The bounding box of the boundary in one view, and the pixel grid over it.                Eqs. (4)-(5)
#include "ngs/ops/field/sample_grid_kernels.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/views.h"

namespace ngs {

inline RayCamera ray_camera(const Camera& camera, double world_unit = 1) {
  return {camera.rotation, camera.translation, camera.centre(), camera.fx,        camera.fy,
          camera.cx,       camera.cy,          camera.width_px, camera.height_px, kNearZ * world_unit};
}

/// The box of the projected centres, grown by `pad_px`, clipped to the image.                   Eq. (4)
/// Centres that project more than pad_px outside the image are not visible. If none is visible: visible == 0 and an
/// empty box.
/// `world_unit`: of math/world_unit.h, for kNearZ.
BoundaryBox boundary_box(const Camera& camera, Rows<const float, 3> boundary, double pad_px, double world_unit = 1);

/// See the overload for a GridShape.
PixelGrid pixel_grid(const PixelBox& box, int rows, int cols);

}  // namespace ngs
