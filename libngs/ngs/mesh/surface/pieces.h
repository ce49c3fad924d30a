#pragma once
// The connected pieces of a closed mesh.
#include <cstddef>

#include "ngs/scene/triangle_mesh.h"

namespace ngs::mesh {

struct PieceCounts {
  std::size_t kept = 0, crumbs = 0, cavities = 0;
};
/// Removes crumbs, pieces with less than `least_share` of the area of the largest one, and cavities, closed pieces
/// whose faces point inwards, and the vertices of no face. The order of the rest is kept.
PieceCounts keep_pieces(double least_share, TriangleMesh& mesh);

}  // namespace ngs::mesh
