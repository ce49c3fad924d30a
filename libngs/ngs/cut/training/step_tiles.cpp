#include "ngs/cut/training/step_tiles.h"

#include <algorithm>

#include "ngs/core/rng.h"
#include "ngs/ops/splat/tile_types.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

int tiles_along(int px) { return (px + kTilePx - 1) / kTilePx; }

/// True: the mask has both sides of a contour in [x0, x1) x [y0, y1).
bool has_contour(const std::vector<float>& mask, int width, int x0, int x1, int y0, int y1) {
  const bool first = mask_is_foreground(mask[std::size_t(y0) * std::size_t(width) + std::size_t(x0)]);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      if (mask_is_foreground(mask[std::size_t(y) * std::size_t(width) + std::size_t(x)]) != first) return true;
  return false;
}

}  // namespace

std::vector<std::uint8_t> contour_tiles(const ViewMasks& masks) {
  if (!masks.available) return {};
  const int w = masks.width_px, h = masks.height_px;
  std::vector<std::uint8_t> near;
  for (int ty = 0; ty < tiles_along(h); ++ty)
    for (int tx = 0; tx < tiles_along(w); ++tx) {
      const int x0 = std::max(0, tx * kTilePx - kNearContour_px),
                x1 = std::min(w, (tx + 1) * kTilePx + kNearContour_px),
                y0 = std::max(0, ty * kTilePx - kNearContour_px),
                y1 = std::min(h, (ty + 1) * kTilePx + kNearContour_px);
      near.push_back(std::any_of(masks.target.begin(), masks.target.end(),
                                 [&](const std::vector<float>& mask) { return has_contour(mask, w, x0, x1, y0, y1); }));
    }
  return near;
}

StepTiles step_tiles(const std::vector<std::uint8_t>& near, int width, int height, double share, std::uint64_t seed,
                     std::int64_t step) {
  StepTiles out{near, std::vector<float>(std::size_t(width) * std::size_t(height))};
  std::vector<float> weight(near.size());
  for (std::size_t t = 0; t < near.size(); ++t) {
    if (near[t]) {
      weight[t] = 1;
    } else if (rng_uniform(seed, RngStream::kTiles, std::uint64_t(step) * near.size() + t) < share) {
      weight[t] = float(1 / share);
    }
    out.rendered[t] = weight[t] > 0;
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.weight[std::size_t(y) * std::size_t(width) + std::size_t(x)] =
          weight[std::size_t(y / kTilePx) * std::size_t(tiles_along(width)) + std::size_t(x / kTilePx)];
  return out;
}

}  // namespace ngs
