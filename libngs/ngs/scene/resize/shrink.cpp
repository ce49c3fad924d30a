#include "ngs/scene/resize/shrink.h"

#include <algorithm>

namespace ngs {
namespace {

struct PixelRect {
  int left, top, right, bottom;
};

float mean_of(const ImageF& image, const PixelRect& r, int channel) {
  double sum = 0;
  for (int y = r.top; y < r.bottom; ++y)
    for (int x = r.left; x < r.right; ++x) sum += double(image.at(x, y, channel));
  return float(sum / ((r.right - r.left) * (r.bottom - r.top)));
}

}  // namespace

ImageF shrunk(const ImageF& image, int factor) {
  if (factor <= 1) return image;
  ImageF out(shrunk_size_px(image.width_px, factor), shrunk_size_px(image.height_px, factor), image.channels);
  for (int y = 0; y < out.height_px; ++y)
    for (int x = 0; x < out.width_px; ++x) {
      const PixelRect cell{x * factor, y * factor, std::min((x + 1) * factor, image.width_px),
                           std::min((y + 1) * factor, image.height_px)};
      for (int c = 0; c < image.channels; ++c) out.at(x, y, c) = mean_of(image, cell, c);
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
