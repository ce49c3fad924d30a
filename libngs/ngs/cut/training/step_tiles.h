#pragma once
// The tiles of a view that a step renders: all at a contour, and a random part of the others, whose losses weigh more.
#include <cstdint>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs {

/// Pixels this far from a contour are near it.
inline constexpr int kNearContour_px = 8;

struct StepTiles {
  std::vector<std::uint8_t> rendered;  // [tiles of kTilePx²] 1: rendered
  std::vector<float> weight;           // [H, W] of the losses; 0: not rendered
};

/// [tiles] 1: pixels of the tile are near a contour of some mask; empty if no masks are available.
std::vector<std::uint8_t> contour_tiles(const ViewMasks& masks);

/// Chooses from the tiles of an image `width` x `height`; those not `near` a contour with the probability `share`.
StepTiles step_tiles(const std::vector<std::uint8_t>& near, int width, int height, double share, std::uint64_t seed,
                     std::int64_t step);

}  // namespace ngs
