#include "ngs/scene/resize.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/check.h"

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

/// Four pixels of a line and their weights in one pixel of the longer line.
struct Taps {
  std::array<int, 4> pixel;
  std::array<double, 4> weight;
};

double keys(double distance) {
  const double a = -0.5;
  const double x = std::abs(distance);
  if (x < 1) return ((a + 2) * x - (a + 3)) * x * x + 1;
  return x < 2 ? a * (((x - 5) * x + 8) * x - 4) : 0;
}

std::vector<Taps> taps_of(int from_px, int to_px) {
  std::vector<Taps> taps(std::size_t(to_px), Taps{});
  for (int i = 0; i < to_px; ++i) {
    const double at = (i + 0.5) * from_px / to_px - 0.5;
    const int first = int(std::floor(at)) - 1;
    for (int t = 0; t < 4; ++t) {
      taps[std::size_t(i)].pixel[std::size_t(t)] = std::clamp(first + t, 0, from_px - 1);
      taps[std::size_t(i)].weight[std::size_t(t)] = keys(at - (first + t));
    }
  }
  return taps;
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
  camera.fx /= factor;
  camera.cx /= factor;
  camera.fy /= factor;
  camera.cy /= factor;
  camera.width_px = shrunk_size_px(camera.width_px, factor);
  camera.height_px = shrunk_size_px(camera.height_px, factor);
  return camera;
}

ImageF enlarged(const ImageF& image, int width_px, int height_px) {
  NGS_CHECK(width_px >= image.width_px && height_px >= image.height_px, "an enlarged image is at least as large");
  const int channels = image.channels;
  ImageF wide(width_px, image.height_px, channels), out(width_px, height_px, channels);
  const std::vector<Taps> across = taps_of(image.width_px, width_px), down = taps_of(image.height_px, height_px);
  for (int y = 0; y < image.height_px; ++y)
    for (int x = 0; x < width_px; ++x)
      for (int c = 0; c < channels; ++c) {
        const Taps& taps = across[std::size_t(x)];
        double sum = 0;
        for (std::size_t t = 0; t < 4; ++t) sum += taps.weight[t] * double(image.at(taps.pixel[t], y, c));
        wide.at(x, y, c) = float(sum);
      }
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x)
      for (int c = 0; c < channels; ++c) {
        const Taps& taps = down[std::size_t(y)];
        double sum = 0;
        for (std::size_t t = 0; t < 4; ++t) sum += taps.weight[t] * double(wide.at(x, taps.pixel[t], c));
        out.at(x, y, c) = float(sum);
      }
  return out;
}

}  // namespace ngs
