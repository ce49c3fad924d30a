#pragma once
// Outlines of a mask along pixel edges, for drawing: closed loops of grid corners (x, y), 0 <= x <= width.
// Each loop has the object on its right (image axes: clockwise around the object, counter-clockwise around a
// hole) and lists only the corners where it turns. Pixels that touch by a corner belong to one loop. The
// loops enclose exactly the mask: the signed areas sum to the number of object pixels.
#include <vector>

#include "ngs/ops/image/metrics.h"

namespace ngs {

struct GridPoint {
  int x = 0, y = 0;
  bool operator==(const GridPoint&) const = default;
};
using Loop = std::vector<GridPoint>;

std::vector<Loop> outlines(MaskPlane mask);

}  // namespace ngs
