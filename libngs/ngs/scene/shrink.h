#pragma once
// Pictures and cameras at an integer fraction of their size. A cell is exactly factor x factor pixels from
// pixel 0 on; the last row and column of cells may stick out, and have fewer pixels. What a pixel saw, its
// cell sees.
#include "ngs/scene/camera.h"
#include "ngs/scene/views.h"

namespace ngs {

inline int shrunk_size_px(int size_px, int factor) { return (size_px + factor - 1) / factor; }

/// Means over the pixels of each cell.
ImageF shrunk(const ImageF& image, int factor);

Camera shrunk(Camera camera, int factor);

}  // namespace ngs
