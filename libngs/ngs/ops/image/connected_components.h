#pragma once
// The 4-connected components of a mask.
#include <vector>

#include "ngs/ops/image/metrics.h"

namespace ngs {

struct ConnectedComponents {
  std::vector<std::int32_t> component;  // [H·W] numbered in order of the first pixel; -1 outside the mask
  std::vector<std::int64_t> size;       // pixels of each
};

ConnectedComponents connected_components(MaskPlane mask);

}  // namespace ngs
