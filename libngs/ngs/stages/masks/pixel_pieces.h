#pragma once
// The 4-connected pieces of a mask.
#include <vector>

#include "ngs/ops/image/metrics.h"

namespace ngs {

struct PixelPieces {
  std::vector<std::int32_t> piece;  // [H·W] numbered in order of the first pixel; -1 outside the mask
  std::vector<std::int64_t> size;   // pixels of each
};

PixelPieces pixel_pieces(MaskPlane mask);

}  // namespace ngs
