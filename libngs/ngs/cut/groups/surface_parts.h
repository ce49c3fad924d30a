#pragma once
// Objects without masks: what the shape and the colours of the surface set apart.
//
// The surface is divided where it is concave: along creases such as those between a table and what stands on it.
// Regions that touch are joined if their colours are alike, the most similar ones first. Floor, walls, what is as far
// out as walls, and regions that are flat (no sides) are no parts. Objects of the same colours that touch are one part.
#include "ngs/cut/groups/surface_cells.h"
#include "ngs/cut/groups/view_gaussians.h"

namespace ngs {

struct SurfaceParts {
  int parts = 0;
  std::vector<std::uint16_t> part;  // [cells] 1 .. parts; 0: none
};

/// `up`: unit length, accurate to 15 degrees.
SurfaceParts surface_parts(const SurfaceCells& cells, Vec3<double> up);

/// The parts in a view, at the size of its depth: kUnknown where the depth steps or the surface has no cell.
NumberedMasks masks_of_parts(const DepthView& view, const SurfaceCells& cells, const SurfaceParts& parts);

}  // namespace ngs
