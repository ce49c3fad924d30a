#pragma once
// Neighbours in space as neighbours in a file: chunks get small extents, pictures smooth gradients.
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// The selection with its rows along a Z-order curve through its bounding box, 2^21 cells a side; rows of one cell keep
/// their order.
SplatSelection along_morton_curve(const SplatSelection& model);

}  // namespace ngs::io
