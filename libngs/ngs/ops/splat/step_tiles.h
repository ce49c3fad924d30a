#pragma once
// The tiles of a view that a training step renders: all that matter, and a random part of the others, whose losses
// weigh more. Losses and gradients are then those of all tiles in the mean.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/scene.h"

namespace ngs {

/// Share of the other tiles, and how far from a contour a pixel matters.
inline constexpr double kFarTiles = 0.25;
inline constexpr int kNearContour_px = 8;

/// [tiles of kTilePx²] 1: the tile matters.
using TileFlags = std::vector<std::uint8_t>;

struct StepTiles {
  TileFlags rendered;  // RenderRequest::tiles
  ImageF weight;       // [H, W, 1] of the losses; 0: not rendered
  double mean_weight = 0;
};

/// Tiles near a contour of some mask; empty if no masks are available.
TileFlags contour_tiles(const ViewMasks& masks);

/// The tiles of step `step` in an image of `width` x `height`.
StepTiles step_tiles(const TileFlags& near, int width, int height, std::uint64_t seed, std::int64_t step);

/// image = target where the weight is 0; target null: 0. On a device, the arrays must be resident.
void keep_weighted(const Exec& exec, const ImageF& weight, const std::vector<float>* target, ImageF& image);

}  // namespace ngs
