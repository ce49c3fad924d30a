#pragma once
// Fewer faces for a closed mesh: edges collapse in the order of their quadric error (Garland and Heckbert 1997).
#include <cstddef>

#include "ngs/scene/triangle_mesh.h"

namespace ngs::mesh {

/// Collapses edges until at most `most_faces` are left. An edge of a watertight 2-manifold mesh collapses only if the
/// mesh stays one, with the same pieces and holes, and if no normal of a face turns by more than 78 degrees; if no edge
/// may collapse, more faces are left. Edges of equal error collapse in the order of their vertices. Colours are
/// removed. Throws kInconsistent if a face names a vertex that does not exist.
void simplify(std::size_t most_faces, TriangleMesh& mesh);

}  // namespace ngs::mesh
