#pragma once
// The cuts of GrabCut on a part of a photo: by OpenCV; in a browser, which has no OpenCV, by colour_cut_web.cpp, which
// gives the same labels (tests/unit/ops/image/colour_cut_test.cpp).
#include <array>

#include "ngs/scene/view_prompt.h"

namespace ngs {

inline constexpr std::size_t kMixtureComponents = 5;  // of the mixture of each side, fixed in OpenCV

/// Sample colours of both sides.
struct SideColours {
  std::vector<std::array<std::uint8_t, 3>> object, background;  // RGB
};

/// A part of a photo, row by row. At least one pixel.
struct HintedRegion {
  int width_px, height_px;
  std::vector<std::array<std::uint8_t, 3>> colour;  // RGB
  std::vector<PixelHint> hint;
};

/// Labels the pixels that are not certain as likely object or likely background, by `iterations` cuts (at least one is
/// made). `known`: at least kMixtureComponents colours of each side, from which the mixtures are learned before the
/// first cut; `seed`: of the clusters.
void colour_cut(HintedRegion& region, const SideColours& known, int iterations, std::uint64_t seed);

}  // namespace ngs
