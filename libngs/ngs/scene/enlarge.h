#pragma once
// Pictures at a larger size.
#include "ngs/scene/views.h"

namespace ngs {

/// Cubic convolution (Keys 1981, a = -1/2): goes through the pixels' values where the sizes' ratio puts a centre on a
/// centre, and keeps linear ramps. Beyond the border the border's value. Neither side may shrink.
ImageF enlarged(const ImageF& image, int width_px, int height_px);

}  // namespace ngs
