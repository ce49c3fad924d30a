#pragma once
// A rectangle of a view: what a pass reads, renders or trains of it.
#include <vector>

#include "ngs/ops/image/mask_pair.h"
#include "ngs/scene/camera.h"
#include "ngs/scene/scene.h"

namespace ngs {

struct PixelWindow {
  int x0 = 0, y0 = 0, w = 0, h = 0;  // px
};

/// The box with a margin, inside of the picture; empty stays empty.
PixelWindow window_about(const ForegroundBox& box, int margin_px, int w, int h);

/// The same about the pixels where any of the [h, w] targets exceeds 0.
PixelWindow window_of(const std::vector<std::vector<float>>& targets, int w, int h, int margin_px);

/// With a margin, on to multiples of 16 px where the picture has them: whole tiles of the picture are whole tiles of
/// the window, and what is drawn there has the same rounding. Empty stays empty.
PixelWindow widened(const PixelWindow& win, int margin_px, int width_px, int height_px);

/// The camera whose whole image is the window.
Camera window_camera(Camera camera, const PixelWindow& win);

/// The window of a plane of `channels` interleaved channels.
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

/// Masks that are available, of the window alone.
ViewMasks cropped(ViewMasks masks, const PixelWindow& win);

}  // namespace ngs
