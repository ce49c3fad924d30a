#pragma once
// Images and cameras at another resolution. Downscaled by an integer factor: a cell is factor x factor pixels, starting
// at pixel 0; cells of the last row and column may extend beyond the image and have fewer pixels. The rays of a pixel
// lie in its cell.
#include "ngs/scene/camera.h"
#include "ngs/scene/views.h"

namespace ngs {

inline int shrunk_size_px(int size_px, int factor) { return (size_px + factor - 1) / factor; }

/// Box filter: the mean over the pixels of each cell.
ImageF shrunk(const ImageF& image, int factor);

Camera shrunk(Camera camera, int factor);

/// Cubic convolution (Keys 1981, a = -1/2): reproduces a pixel's value where pixel centres coincide, and linear ramps.
/// Clamped to the border. Neither side may shrink (NGS_CHECK).
ImageF enlarged(const ImageF& image, int width_px, int height_px);

}  // namespace ngs
