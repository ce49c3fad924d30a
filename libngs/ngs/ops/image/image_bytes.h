#pragma once
// Images in [0, 1] as bytes.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "ngs/scene/views.h"

namespace ngs {

/// Rounded to nearest; values outside [0, 1] are clamped. Values must not be NaN.
inline ImageU8 to_bytes(const ImageF& image) {
  ImageU8 bytes(image.width_px, image.height_px, image.channels);
  for (std::size_t i = 0; i < bytes.data.size(); ++i)
    bytes.data[i] = std::uint8_t(std::lround(255 * std::clamp(image.data[i], 0.f, 1.f)));
  return bytes;
}

}  // namespace ngs
