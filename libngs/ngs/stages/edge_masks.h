#pragma once
// The masks that a round of edge_stage.h trains on: the labels as rendered, walked to the photo's edges.
#include "ngs/stages/edge_stage.h"

namespace ngs {

struct PixelWindow {
  int x0 = 0, y0 = 0, w = 0, h = 0;
};

/// What a round trains a view on: the window and, in it, the walked masks.
struct WalkedView {
  PixelWindow window;
  ViewMasks masks;  // of the window's size
  // Mean boundary IoU with the view's own masks; only where the view supervises and has them.
  bool compared = false;
  double rendered_biou = 0, walked_biou = 0;
  double own_contrast = 0, walked_contrast = 0;  // of the photo across the contours
};

/// Photos are read at up to twice the camera's size. `compare`: fill the figures that the view's own masks
/// give; for views that supervise only. Without a photo or a labelled pixel masks are not available. Serial.
WalkedView walk_view(const EdgeSetup& setup, const GaussianCloud& cloud,
                     const std::vector<LabelColumns>& labels, std::size_t v, bool compare);

/// The window of a plane with interleaved channels.
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

}  // namespace ngs
