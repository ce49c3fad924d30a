#pragma once
// Images and cameras downscaled by an integer factor. A cell is factor x factor pixels, starting at pixel 0. Cells of
// the last row and column may extend beyond the image and have fewer pixels. The rays of a pixel lie in its cell.
#include "ngs/scene/camera.h"
#include "ngs/scene/views.h"

namespace ngs {

inline int shrunk_size_px(int size_px, int factor) { return (size_px + factor - 1) / factor; }

/// Box filter: the mean over the pixels of each cell.
ImageF shrunk(const ImageF& image, int factor);

Camera shrunk(Camera camera, int factor);

}  // namespace ngs
