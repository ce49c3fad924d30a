#pragma once
// What a segmenter is told about one view: which pixels are certain, which are only likely. Written by
// stages, read by segmenters (the built-in one and programs of the user).
#include <cstdint>
#include <vector>

#include "ngs/scene/views.h"

namespace ngs {

/// What is known about a pixel before it is segmented. The numbers are those of GrabCut.
enum class PixelHint : std::uint8_t { kBackground = 0, kObject = 1, kLikelyBackground = 2, kLikelyObject = 3 };

inline bool is_certain(PixelHint hint) { return hint == PixelHint::kBackground || hint == PixelHint::kObject; }
inline bool is_object(PixelHint hint) { return hint == PixelHint::kObject || hint == PixelHint::kLikelyObject; }

struct ViewPrompt {
  int width_px = 0, height_px = 0;
  std::vector<PixelHint> hint;  // [H·W]
  bool by_hand = false;         // strokes or boxes of a person on an otherwise unknown view
};

/// The segmented mask of one view: [H·W] 1: object.
using PixelMask = std::vector<std::uint8_t>;

}  // namespace ngs
