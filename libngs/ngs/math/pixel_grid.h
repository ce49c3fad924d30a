#pragma once
// A regular lattice of pixel positions and the bilinear relations between its nodes and an image.
#include "ngs/core/hd.h"
#include "ngs/math/stable.h"

namespace ngs {

/// Node (row, col) lies at (first_x + col·step_x, first_y + row·step_y), in pixel coordinates (centres at
/// +0.5). Rows are stored one after the other: node index = row·cols + col.
struct PixelGrid {
  double first_x = 0, first_y = 0, step_x = 1, step_y = 1;  // px; steps >= 1
  int cols = 0, rows = 0;

  NGS_HD long long nodes() const { return static_cast<long long>(cols) * rows; }
  NGS_HD double x(int col) const { return first_x + step_x * col; }
  NGS_HD double y(int row) const { return first_y + step_y * row; }
};

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

/// The weight with which `bilinear_axis(position_px, size_px)` reads `pixel`: the same numbers, asked from
/// the pixel's side, so that a transposed sum can gather.
NGS_HD inline double bilinear_weight(double position_px, int size_px, int pixel) {
  const BilinearAxis axis = bilinear_axis(position_px, size_px);
  double weight = axis.lower == pixel ? 1 - axis.weight : 0;
  if (axis.upper == pixel) weight += axis.weight;
  return weight;
}

/// A range of nodes along one axis; empty if last < first.
struct NodeRange {
  int first, last;
};
/// The nodes of one axis that may lie within `reach_px` of a pixel's centre after clamping to the image: a
/// superset, never missing one.
NGS_HD inline NodeRange nodes_near(double first_px, double step_px, int count, int size_px, int pixel,
                                   double reach_px) {
  const double centre = pixel + 0.5;
  const double low = (centre - reach_px - first_px) / step_px - 1e-6,
               high = (centre + reach_px - first_px) / step_px + 1e-6;
  // Nodes beyond the border are read from the border pixels.
  const bool at_low_border = centre - reach_px <= 0.5, at_high_border = centre + reach_px >= size_px - 0.5;
  NodeRange range{at_low_border || low <= 0 ? 0 : int(low), count - 1};
  if (!at_high_border && high < count - 1) range.last = high < 0 ? -1 : int(high);
  return range;
}

}  // namespace ngs
