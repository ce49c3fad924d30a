#pragma once
// Where parallel rays are inside closed meshes: the ray (i, j) runs along +z through x = i pitch, y = j pitch, grid
// steps.
#include <array>
#include <vector>

#include "ngs/mesh/collider/exact_grid.h"

namespace ngs::mesh {

struct RaySpan {
  std::int32_t i, j;
  double low, high;                   ///< z, grid steps
  std::uint32_t low_face, high_face;  ///< rows of the mesh's faces
};

/// A closed mesh on the grid.
struct GridMesh {
  std::vector<GridPoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// Sorted by i, j, z. A ray through a vertex or along an edge meets one of the faces there. Inside is where the rays
/// have entered through more faces than they have left through, so solids may overlap.
std::vector<RaySpan> spans_inside(const GridMesh& mesh, std::int64_t pitch);

/// Grid steps^3, by rays; the volume along a ray is exact.
struct Difference {
  double in_mesh_only = 0;
  double in_parts_only = 0;
  std::vector<GridPoint> outside;  ///< of each stretch of a ray in parts only: both ends and the middle
};
/// Between the mesh and the union of the parts.
Difference difference_of(const GridMesh& mesh, const std::vector<GridMesh>& parts, std::int64_t pitch);

}  // namespace ngs::mesh
