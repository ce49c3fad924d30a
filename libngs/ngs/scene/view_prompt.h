#pragma once
// Per-pixel prompt of a segmenter for one view: certain and likely object or background. Written by stages, read by
// segmenters (built-in or external programs).
#include <cstdint>
#include <vector>

#include "ngs/scene/views.h"

namespace ngs {

/// Prior of a pixel before segmentation. The numbers are those of GrabCut (OpenCV).
enum class PixelHint : std::uint8_t { kBackground = 0, kObject = 1, kLikelyBackground = 2, kLikelyObject = 3 };

inline bool is_certain(PixelHint hint) { return hint == PixelHint::kBackground || hint == PixelHint::kObject; }
inline bool is_object(PixelHint hint) { return hint == PixelHint::kObject || hint == PixelHint::kLikelyObject; }

struct ViewPrompt {
  int width_px = 0, height_px = 0;
  std::vector<PixelHint> hint;  // [H·W]
  bool by_hand = false;         // strokes or boxes by a user; all else in the view is unknown
};

/// The segmented mask of one view: [H·W] 1: object.
using PixelMask = std::vector<std::uint8_t>;

/// [H·W] 1: a pixel with this hint.
inline PixelMask pixels_with(const ViewPrompt& prompt, PixelHint hint) {
  PixelMask mask(prompt.hint.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = prompt.hint[p] == hint;
  return mask;
}

}  // namespace ngs
