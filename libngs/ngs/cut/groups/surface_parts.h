#pragma once
// Segments objects without masks, by the shape and the colours of the surface.
//
// The surface is cut along concave creases, such as those between a table and the things on it. Adjacent regions with
// similar colours are joined, the most similar ones first. Floor, walls, regions as far out as walls, and flat regions
// (no sides) are discarded. Limit: objects of the same colours that touch become one part.
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
