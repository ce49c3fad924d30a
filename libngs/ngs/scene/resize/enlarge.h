#pragma once
// Upscaling of images.
#include "ngs/scene/views.h"

namespace ngs {

/// Cubic convolution (Keys 1981, a = -1/2): reproduces a pixel's value where pixel centres coincide, and linear ramps.
/// Clamped to the border. Neither side may shrink (NGS_CHECK).
ImageF enlarged(const ImageF& image, int width_px, int height_px);

}  // namespace ngs
