#pragma once
// Objects without masks: what stands on the floor of a model, or with others on something that stands there.
//
// The floor is the level plane with nearly nothing below. Without it the surface falls into connected pieces; those
// that reach through half of the model, or have nearly nothing behind them (walls, a ceiling), belong to no object. A
// piece is divided at a level surface that carries two pieces or more and is larger than what they cover of it, or that
// carries one piece a third as wide: a table and the objects on it. The top of a pedestal is part of the same object as
// what stands on it. Objects that touch each other are one part.
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
