#pragma once
// Which Gaussians and tiles of a view are needed, so that the others are neither projected nor rasterised. Internal to
// ops. Pixels of skipped tiles are undefined, and so is a Gaussian's contribution behind `stop_after` or `max_depth`:
// the caller must not read them.
#include <cstdint>

#include "ngs/scene/views.h"

namespace ngs {

struct CullRequest {
  const std::uint8_t* tiles_touching = nullptr;  // [N] 1: skip tiles that none of these touches; null: no tile
  const std::uint8_t* stop_after = nullptr;      // [N] 1: skip Gaussians behind a tile's last one of these; null: none
  const ImageF* max_depth = nullptr;  // [H, W, 1] skip Gaussians at this depth or farther; 0: all; null: none
};

}  // namespace ngs
