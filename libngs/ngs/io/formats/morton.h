#pragma once
// Morton (Z-order) sorting: chunks of rows get small extents, attribute images smooth gradients.
#include <vector>

#include "ngs/io/formats/splat_table.h"

namespace ngs::io {

/// The selection with its rows sorted along a Z-order curve through its bounding box, 2^21 cells per axis. Rows of one
/// cell keep their order.
SplatSelection along_morton_curve(const SplatSelection& model);

}  // namespace ngs::io
