#pragma once
// Measures of a triangle mesh.
#include <cstddef>

#include "ngs/scene/triangle_mesh.h"

namespace ngs::mesh {

struct MeshMeasures {
  double volume = 0;             ///< signed, world units^3: of a closed mesh, positive if its faces point outwards
  double area = 0;               ///< world units^2
  std::size_t border_edges = 0;  ///< directed edges without a face on their other side; 0 if the mesh is watertight
  std::size_t non_manifold_edges = 0;  ///< directed edges of two or more faces
};
/// Of an empty mesh all are 0. Throws kInconsistent if a face names a vertex that does not exist.
MeshMeasures measures_of(const TriangleMesh& mesh);

}  // namespace ngs::mesh
