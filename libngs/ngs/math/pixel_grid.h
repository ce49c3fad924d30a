#pragma once
// A regular lattice of pixel positions and the bilinear relations between its nodes and an image.
#include "ngs/core/hd.h"
#include "ngs/math/stable.h"

namespace ngs {

/// Axis-aligned box in pixel coordinates: pixel (i, j) covers [i, i + 1) x [j, j + 1).
struct PixelBox {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;  // px
};

/// Node (row, col) lies at (first_x + col·step_x, first_y + row·step_y), in pixel coordinates (centres at
/// +0.5). Rows are stored one after the other: node index = row·cols + col.
struct PixelGrid {
  double first_x = 0, first_y = 0, step_x = 1, step_y = 1;  // px; steps >= 1
  int cols = 0, rows = 0;
  double beyond_x = 0, beyond_y = 0;  // px from the outer nodes to the border of the box that the lattice samples

  NGS_HD long long nodes() const { return static_cast<long long>(cols) * rows; }
  NGS_HD double x(int col) const { return first_x + step_x * col; }
  NGS_HD double y(int row) const { return first_y + step_y * row; }
};

/// The box that the lattice samples.
NGS_HD inline PixelBox box_of(const PixelGrid& g) {
  return {g.first_x - g.beyond_x, g.first_y - g.beyond_y, g.x(g.cols - 1) + g.beyond_x, g.y(g.rows - 1) + g.beyond_y};
}

/// The two pixels along one axis between whose centres `position_px` lies, and the weight of the upper one.
/// Positions beyond the first or last centre take that pixel alone.
struct BilinearAxis {
  int lower, upper;
  double weight;  // of `upper`
};
NGS_HD inline BilinearAxis bilinear_axis(double position_px, int size_px) {
  const double at = clamp3(position_px - 0.5, 0.0, double(size_px - 1));
  const int lower = int(at);
  return {lower, lower + 1 < size_px ? lower + 1 : lower, at - lower};
}

/// Bilinear interpolation between four pixels; at(x, y) is the value of a pixel.
template <class At>
NGS_HD double read_bilinear(double x_px, double y_px, int width_px, int height_px, const At& at) {
  const BilinearAxis x = bilinear_axis(x_px, width_px), y = bilinear_axis(y_px, height_px);
  const auto row = [&](int line) {
    return (1 - x.weight) * double(at(x.lower, line)) + x.weight * double(at(x.upper, line));
  };
  return (1 - y.weight) * row(y.lower) + y.weight * row(y.upper);
}

/// The weight with which `bilinear_axis(position_px, size_px)` reads `pixel`: the same numbers, seen from the pixel, so
/// that a transposed sum can gather.
NGS_HD inline double bilinear_weight(double position_px, int size_px, int pixel) {
  const BilinearAxis axis = bilinear_axis(position_px, size_px);
  double weight = axis.lower == pixel ? 1 - axis.weight : 0;
  if (axis.upper == pixel) weight += axis.weight;
  return weight;
}

/// The nodes of a grid along one axis.
struct NodeAxis {
  double first_px, step_px;
  int count;
};
/// A range of nodes along one axis; empty if last < first.
struct NodeRange {
  int first, last;
};
/// The nodes of one axis that may lie within `reach_px` of a pixel's centre after clamping to the image: a superset
/// that misses none.
NGS_HD inline NodeRange nodes_near(const NodeAxis& axis, int size_px, int pixel, double reach_px) {
  const double centre = pixel + 0.5;
  const double low = (centre - reach_px - axis.first_px) / axis.step_px - 1e-6,
               high = (centre + reach_px - axis.first_px) / axis.step_px + 1e-6;
  // Nodes beyond the border are read from the border pixels.
  const bool at_low_border = centre - reach_px <= 0.5, at_high_border = centre + reach_px >= size_px - 0.5;
  NodeRange range{at_low_border || low <= 0 ? 0 : int(low), axis.count - 1};
  if (!at_high_border && high < axis.count - 1) range.last = high < 0 ? -1 : int(high);
  return range;
}

}  // namespace ngs
