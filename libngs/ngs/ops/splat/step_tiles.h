#pragma once
// The tiles of a view that a training step renders: all that matter, and the others in one of four cells, in a pattern
// with a random offset, whose losses weigh four times as much. Losses and gradients are then those of all tiles in the
// mean. A cell of several tiles is touched by fewer Gaussians than as many single tiles.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// One in so many cells of kCellTiles x kCellTiles other tiles, and how far from a contour a pixel matters.
inline constexpr int kFarTiles = 4, kCellTiles = 4;
inline constexpr int kNearContour_px = 8;

/// [tiles of kTilePx²] 1: the tile matters.
using TileFlags = std::vector<std::uint8_t>;

/// The tiles with a flagged pixel. `pixel` [height, width].
TileFlags tiles_with(const std::vector<std::uint8_t>& pixel, int width, int height);

struct StepTiles {
  int offset = 0;      // of the pattern
  TileFlags rendered;  // RenderRequest::tiles
  double weight = 0;   // sum of the weights of all pixels
};

/// Tiles near a contour of some mask; empty if no masks are available.
TileFlags contour_tiles(const ViewMasks& masks);

/// The tiles of step `step` in an image of `width` x `height`.
StepTiles step_tiles(const TileFlags& near, int width, int height, std::uint64_t seed, std::int64_t step);

/// The weights [H, W, 1] of the losses, 0 in tiles that are not rendered. On a device, the arrays must be resident.
void weigh_pixels(const Exec& exec, const TileFlags& near, const StepTiles& tiles, ImageF& weight);

/// image = target where the weight is 0; target null: 0. On a device, the arrays must be resident.
void keep_weighted(const Exec& exec, const ImageF& weight, const std::vector<float>* target, ImageF& image);

}  // namespace ngs
