#pragma once
// What of a view is asked for, so that the rest is neither projected nor drawn. Internal to ops.
#include <cstdint>

#include "ngs/scene/views.h"

namespace ngs {

struct Asked {
  const std::uint8_t* where = nullptr;  // [N] 1: tiles that none of these reaches are not asked for; null: all are
  const std::uint8_t* until = nullptr;  // [N] 1: nor, in a tile, is what lies behind the last of these; null: it is
  const ImageF* limit = nullptr;        // [H, W, 1] nor is what is not nearer than a pixel's; 0: nothing is; null: all
};

}  // namespace ngs
