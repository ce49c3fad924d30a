#pragma once
// Usual mistakes of masks, each with what undoes it.
#include <string>
#include <vector>

#include "ngs/scene/view_prompt.h"

namespace ngs {

/// Inverted masks cover more than this share of the image's border.
inline constexpr double kAllRound = 0.85;

/// Undoes a mistake: view v gets the mask of view v * `stretch` + `shift` (of the last view but v if `reversed`),
/// turned and inverted. Pixel (x, y) of the new mask is pixel T(x, y) of the old one; T flips first, and then swaps x
/// and y.
struct MaskRepair {
  struct Size {
    int width_px = 0, height_px = 0;
    bool operator==(const Size&) const = default;
  };
  /// The mask [from.height, from.width], turned and inverted, at another size.
  PixelMask turned(const PixelMask& mask, Size from, Size to) const;

  std::string mistake;            // "mirrored"
  const char* mogrify = nullptr;  // option of ImageMagick that undoes it in the file; null: none
  int shift = 0;                  // views, in the order of their names
  double stretch = 1;             // 2: masks of every frame, photos of every second one; 0.5: the reverse
  bool reversed = false, inverted = false;
  bool flip_x = false, flip_y = false, swap_xy = false;
};

/// The usual mistakes that change all masks in the same way, or single ones.
const std::vector<MaskRepair>& mask_repairs();

}  // namespace ngs
