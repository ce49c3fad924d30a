#pragma once
// A rectangular crop of a view.
#include <vector>

#include "ngs/ops/image/mask_pair.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct PixelWindow {
  int x0 = 0, y0 = 0, w = 0, h = 0;  // px

  std::size_t pixels() const { return std::size_t(w) * std::size_t(h); }
  /// Index of the window's pixel (x, y) in a plane of the window.
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(w) + std::size_t(x); }
};

/// The box grown by a margin and clipped to the image; empty if the box is empty.
PixelWindow window_about(const ForegroundBox& box, int margin_px, int w, int h);

/// The same for the box of the pixels where any of the [h, w] targets exceeds 0.
PixelWindow window_of(const std::vector<std::vector<float>>& targets, int w, int h, int margin_px);

/// The window grown by a margin to multiples of 16 px, clipped to the image. Tiles of the image are then tiles of the
/// window, so a rendering of the window has the same rounding. Empty if the window is empty.
PixelWindow widened(const PixelWindow& win, int margin_px, int width_px, int height_px);

/// The camera of the cropped image.
Camera window_camera(Camera camera, const PixelWindow& win);

/// Crops a plane of `channels` interleaved channels.
template <class T>
std::vector<T> cropped(const std::vector<T>& plane, int width_px, int channels, const PixelWindow& win) {
  std::vector<T> out;
  out.reserve(std::size_t(win.w) * std::size_t(win.h) * std::size_t(channels));
  for (int y = win.y0; y < win.y0 + win.h; ++y) {
    const auto row = plane.begin() + (std::ptrdiff_t(y) * width_px + win.x0) * channels;
    out.insert(out.end(), row, row + std::ptrdiff_t(win.w) * channels);
  }
  return out;
}

/// Crops masks, which must be available.
ViewMasks cropped(ViewMasks masks, const PixelWindow& win);

}  // namespace ngs
