#include "ngs/ops/splat/step_tiles.h"

#include <algorithm>

#include "ngs/core/rng.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/ops/splat/tile_types.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

struct Box {
  int x0, x1, y0, y1;  // [x0, x1) x [y0, y1)
};

/// True: the mask has both sides of a contour in the box.
bool has_contour(const std::vector<float>& mask, int width, const Box& box) {
  const auto inside = [&](int x, int y) {
    return mask_is_foreground(mask[std::size_t(y) * std::size_t(width) + std::size_t(x)]);
  };
  const bool first = inside(box.x0, box.y0);
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x)
      if (inside(x, y) != first) return true;
  return false;
}

}  // namespace

TileFlags tiles_with(const std::vector<std::uint8_t>& pixel, int width, int height) {
  TileFlags tiles(std::size_t(tiles_across(width)) * std::size_t(tiles_across(height)), 0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (pixel[std::size_t(y) * std::size_t(width) + std::size_t(x)] != 0)
        tiles[std::size_t(y / kTilePx) * std::size_t(tiles_across(width)) + std::size_t(x / kTilePx)] = 1;
  return tiles;
}

TileFlags contour_tiles(const ViewMasks& masks) {
  if (!masks.available) return {};
  const int w = masks.width_px, h = masks.height_px;
  constexpr int kReach = kTilePx + kNearContour_px;
  TileFlags near;
  for (int y = 0; y < h; y += kTilePx)
    for (int x = 0; x < w; x += kTilePx)
      near.push_back(std::ranges::any_of(masks.target, [&](const std::vector<float>& mask) {
        return has_contour(mask, w,
                           {std::max(0, x - kNearContour_px), std::min(w, x + kReach), std::max(0, y - kNearContour_px),
                            std::min(h, y + kReach)});
      }));
  return near;
}

StepTiles step_tiles(const TileFlags& near, int width, int height, std::uint64_t seed, std::int64_t step) {
  StepTiles out;
  out.offset = int(rng_bits(seed, RngStream::kTiles, std::uint64_t(step)) % kFarTiles);
  const WeighTiles weigh{width, kTilePx, kCellTiles, kFarTiles, out.offset, near.data(), nullptr};
  for (int y = 0; y < height; y += kTilePx)
    for (int x = 0; x < width; x += kTilePx) {
      const int weight = weigh.of_tile(x / kTilePx, y / kTilePx);
      out.rendered.push_back(weight > 0);
      out.weight += double(weight) * std::min(kTilePx, width - x) * std::min(kTilePx, height - y);
    }
  return out;
}

void weigh_pixels(const Exec& exec, const TileFlags& near, const StepTiles& tiles, ImageF& weight) {
  const WeighTiles weigh{weight.width_px, kTilePx,     kCellTiles,        kFarTiles,
                         tiles.offset,    near.data(), weight.data.data()};
  for_each_row(exec, std::int64_t(weigh.across()) * weight.height_px, weigh);
}

void keep_weighted(const Exec& exec, const ImageF& weight, const std::vector<float>* target, ImageF& image) {
  for_each_row(exec, image.pixels(),
               KeepWeighted{image.channels, weight.data.data(), target ? target->data() : nullptr, image.data.data()});
}

}  // namespace ngs
