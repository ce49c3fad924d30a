#pragma once
// Approximate convex decomposition: a solid is cut by planes until the hulls of the pieces add little volume, then
// pieces are joined again (after Mamou and Ghorbel 2009, HACD, and Wei et al. 2022, CoACD).
#include "ngs/backend/exec.h"
#include "ngs/mesh/collider/piece.h"

namespace ngs::mesh {

/// Hulls of at most `parts` (>= 1) pieces, that together hold nearly all of the solid; they may overlap. `volume` of
/// the solid, grid steps^3, > 0, sets the lattice. Pieces of a solid in more than `parts` parts are joined too.
std::vector<ConvexHull> convex_parts(const Exec& exec, const GridMesh& solid, double volume, int parts);

}  // namespace ngs::mesh
