#include "ngs/capture/mask_repair.h"

#include <utility>

namespace ngs {

const std::vector<MaskRepair>& mask_repairs() {
  static const std::vector<MaskRepair> repairs{
      {.mistake = "mirrored", .mogrify = "-flop", .flip_x = true},
      {.mistake = "upside down", .mogrify = "-flip", .flip_y = true},
      {.mistake = "turned by 180 degrees", .mogrify = "-rotate 180", .flip_x = true, .flip_y = true},
      {.mistake = "transposed", .mogrify = "-transpose", .swap_xy = true},
      {.mistake = "turned by 90 degrees to the left", .mogrify = "-rotate 90", .flip_x = true, .swap_xy = true},
      {.mistake = "turned by 90 degrees to the right", .mogrify = "-rotate -90", .flip_y = true, .swap_xy = true},
      {.mistake = "transposed and turned", .mogrify = "-transverse", .flip_x = true, .flip_y = true, .swap_xy = true},
      {.mistake = "inverted", .mogrify = "-negate", .inverted = true}};
  return repairs;
}

PixelMask MaskRepair::turned(const PixelMask& mask, Size from, Size to) const {
  PixelMask out;
  out.reserve(std::size_t(to.width_px) * std::size_t(to.height_px));
  for (int y = 0; y < to.height_px; ++y)
    for (int x = 0; x < to.width_px; ++x) {
      double u = (x + 0.5) / to.width_px, v = (y + 0.5) / to.height_px;
      if (flip_x) u = 1 - u;
      if (flip_y) v = 1 - v;
      if (swap_xy) std::swap(u, v);
      const std::size_t row = std::size_t(int(v * from.height_px)) * std::size_t(from.width_px);
      out.push_back((mask[row + std::size_t(int(u * from.width_px))] != 0) != inverted);
    }
  return out;
}

}  // namespace ngs
