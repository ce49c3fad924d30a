#pragma once
// Which Gaussians and tiles of a view are needed, so that the others are neither projected nor rasterised. Internal to
// ops. Pixels of skipped tiles are undefined, and so is a Gaussian's contribution behind `stop_after` or `max_depth`:
// the caller must not read them.
#include <cstdint>

#include "ngs/scene/views.h"

namespace ngs {

struct CullRequest {
  /// [N] Render only tiles that a flagged Gaussian touches; null: all tiles.
  const std::uint8_t* tiles_touching = nullptr;
  /// [N] Per tile, skip everything behind the last flagged Gaussian; null: nothing.
  const std::uint8_t* stop_after = nullptr;
  /// [H, W, 1] Skip Gaussians at this depth or farther, all where it is 0; null: none.
  const ImageF* max_depth = nullptr;
  /// [tiles] 0: do not render the tile; null: all tiles. Not combined with the others.
  const std::uint8_t* tiles = nullptr;
};

}  // namespace ngs
