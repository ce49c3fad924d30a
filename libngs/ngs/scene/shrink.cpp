#include "ngs/scene/shrink.h"

#include <algorithm>

namespace ngs {

ImageF shrunk(const ImageF& image, int factor) {
  if (factor <= 1) return image;
  ImageF out(shrunk_size_px(image.width_px, factor), shrunk_size_px(image.height_px, factor), image.channels);
  for (int y = 0; y < out.height_px; ++y)
    for (int x = 0; x < out.width_px; ++x) {
      const int right = std::min((x + 1) * factor, image.width_px),
                bottom = std::min((y + 1) * factor, image.height_px);
      for (int c = 0; c < image.channels; ++c) {
        double sum = 0;
        for (int v = y * factor; v < bottom; ++v)
          for (int u = x * factor; u < right; ++u) sum += double(image.at(u, v, c));
        out.at(x, y, c) = float(sum / ((right - x * factor) * (bottom - y * factor)));
      }
    }
  return out;
}

Camera shrunk(Camera camera, int factor) {
  camera.fx /= factor, camera.cx /= factor, camera.fy /= factor, camera.cy /= factor;
  camera.width_px = shrunk_size_px(camera.width_px, factor);
  camera.height_px = shrunk_size_px(camera.height_px, factor);
  return camera;
}

}  // namespace ngs
