#pragma once
// The hole that a removed object leaves in one surface, as cells of a square grid in the surface's coordinates.
//
// A cell belongs to the hole in two cases. First, no Gaussian covers it, and it lies in the object's projection along
// the normal, dilated by a margin. Second, the object stands on it and hides it from most directions: Gaussians there
// were trained by few views and show the object's contact shadow. A connected part of such cells is dropped in two
// cases. First, more than a quarter of its outline is open: the surface ends there. Second, Gaussians about as dense as
// at the rim cover most of it: the surface continues below the object. If they are twice as dense, they are remains of
// the object.
#include <cstdint>
#include <vector>

#include "ngs/edit/fill/fill_surface.h"
#include "ngs/edit/fill/occluder.h"

namespace ngs {

enum class HoleCell : std::uint8_t {
  kOpen,     // no Gaussian covers it; not in the hole
  kWeak,     // partly covered
  kCovered,  // covered: its colour is known
  kClipped,  // behind another surface
  kHole
};

/// Numbers of cells below the object's standing part: all; those in the hole; those that the background covers.
struct Footprint {
  std::int64_t cells = 0, filled = 0, covered = 0;
};

struct HoleCells {
  std::int64_t columns = 0, rows = 0;
  double side = 0;              // of a cell, world
  Vec2<double> low{0, 0};       // corner of cell 0, surface coordinates
  std::vector<HoleCell> state;  // [rows · columns]
  std::vector<float> colour;    // [rows · columns, 3] sh_dc as seen along the normal; 0 where nothing is covered
  std::int64_t hole = 0;        // cells of the hole
  std::int64_t one_sided = 0;   // cells left out because the rim is missing on one side
  std::int64_t continued = 0;   // cells left out because the surface continues below the object
  Footprint footprint;

  Vec2<double> centre(std::int64_t cell) const {
    const std::int64_t column = cell % columns, row = cell / columns;
    return {low.x + (double(column) + 0.5) * side, low.y + (double(row) + 0.5) * side};
  }
  /// The cell of a point; -1: outside of the grid.
  std::int64_t cell_of(Vec2<double> at) const;
};

struct HoleScene {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& object;  // [N] 1: removed
  const Rim& rim;
  const Occluder& occluder;
  const std::vector<FillSurface>& surfaces;
  const std::vector<std::uint8_t>& debris;  // [rim.background] 1: is removed, covers nothing
};

/// The hole in scene.surfaces[index].
HoleCells find_hole_cells(const Exec& exec, const HoleScene& scene, std::size_t index);

/// Share of a Gaussian, projected onto the surface, that lies in the hole, in [0, 1].
double share_in_hole(const GaussianCloud& cloud, const FillSurface& surface, const HoleCells& cells, std::size_t row);

/// Dilates the marked cells of a surface by `margin` cells (chessboard distance).
std::vector<std::uint8_t> dilated(const HoleCells& cells, std::vector<std::uint8_t> marked, int margin);

}  // namespace ngs
