#pragma once
// The surface that the views of a model show, as occupied cells of a grid.
//
// A pixel gives a surface point at its expected depth. Pixels at depth steps are skipped, because they mix foreground
// and background. The side of a cell is kCellPixels times the median pixel size on the surface. Dropped are cells that
// only one view shows, and cells that more views see through than show.
#include <cstdint>
#include <vector>

#include "ngs/math/cell_grid.h"
#include "ngs/ops/splat/splat.h"

namespace ngs {

/// Depth and colours of a view.
struct DepthView {
  Camera camera;  // relative to the model's origin
  ImageF depth;   // [H, W, 1] camera z, world; 0: nothing, or a step
  ImageF colour;  // [H, W, 3] in [0, 1]; undefined where the depth is 0

  /// The point that a pixel shows, relative to the model's origin. Its depth must not be 0.
  Vec3<double> point(int x, int y) const;
};

/// The view at most kDepthSide_px wide and high.
inline constexpr int kDepthSide_px = 400;
DepthView depth_view(const Exec& exec, const GaussianCloud& cloud, const Camera& camera, const SplatOptions& splat);

struct SurfaceCells {
  static constexpr double kCellPixels = 1.5;
  double side = 1;                       // world
  Vec3<double> centre{0, 0, 0};          // of the grid, relative to the model's origin
  std::vector<std::uint64_t> key;        // [M] CellGrid, ascending
  std::vector<Vec3<double>> position;    // [M] mean of the points in it, relative to the model's origin
  std::vector<Vec3<double>> normal;      // [M] towards the cameras, at most unit length
  std::vector<Vec3<double>> colour;      // [M] mean of the points in it, in [0, 1]
  std::vector<std::size_t> first_of;     // [M + 1] range of a cell in `neighbour`
  std::vector<std::uint32_t> neighbour;  // occupied cells that share a face, an edge or a corner

  std::size_t count() const { return key.size(); }
  /// The cell of a point relative to the model's origin; -1: not occupied.
  std::int64_t at(Vec3<double> point) const;
};

/// No cells if no view shows a surface.
SurfaceCells surface_cells(const Exec& exec, const std::vector<DepthView>& views);

}  // namespace ngs
