#pragma once
// Where the boundary lies in one view, and the pixel grid laid over it.                    Eqs. (4)-(5)
#include <cstdint>

#include "ngs/math/pixel_grid.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/query_field.h"
#include "ngs/scene/views.h"

namespace ngs {

struct BoundaryBox {
  PixelBox box;              // clipped to the image; empty (all 0) if visible == 0
  std::int64_t visible = 0;  // boundary Gaussians in front of the camera that project into the padded image
  double mean_distance = 0;  // world, Euclidean, from the camera centre, over the visible ones (C12)
};

/// Gaussians nearer than this (camera z, world) do not count: their projection is meaningless.
inline constexpr double kNearZ = 0.01;

/// The box of the projected centres, grown by `pad_px`, clipped to the image.                   Eq. (4)
/// Centres that project outside the image by more than pad_px are not visible. No Gaussians, none in front,
/// or none in the image: visible == 0 and an empty box.
BoundaryBox boundary_box(const Camera& camera, Rows<const float, 3> boundary, double pad_px);

/// kCentres: rows x cols nodes in the middles of the cells. kInclusive: the paper's 0 <= k <= N, that is
/// (rows + 1) x (cols + 1) nodes on the cells' corners (C7).
enum class GridNodes : std::uint8_t { kCentres, kInclusive };

/// At most rows x cols cells over the box, fewer where they would be smaller than 1 px.         Eq. (5)
/// A box thinner than 1 px has one node on that axis, in its middle; an empty box has no nodes.
PixelGrid pixel_grid(const PixelBox& box, int rows, int cols, GridNodes nodes);

}  // namespace ngs
