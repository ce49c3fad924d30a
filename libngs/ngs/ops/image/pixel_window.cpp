#include "ngs/ops/image/pixel_window.h"

#include <algorithm>

namespace ngs {

PixelWindow window_about(const ForegroundBox& box, int margin_px, int w, int h) {
  if (box.empty()) return {};
  const int x0 = std::max(0, box.x0 - margin_px), y0 = std::max(0, box.y0 - margin_px);
  return {x0, y0, std::min(w, box.x1 + margin_px) - x0, std::min(h, box.y1 + margin_px) - y0};
}

PixelWindow window_of(const std::vector<std::vector<float>>& targets, int w, int h, int margin_px) {
  ForegroundBox shown;
  for (const std::vector<float>& target : targets) shown.add(foreground_box(target, w, h));
  return window_about(shown, margin_px, w, h);
}

PixelWindow widened(const PixelWindow& win, int margin_px, int width_px, int height_px) {
  constexpr int kGrain_px = 16;
  if (win.w == 0) return {};
  const auto down = [&](int v) { return std::max(0, v - margin_px) / kGrain_px * kGrain_px; };
  const auto up = [&](int v, int side_px) {
    return std::min(side_px, (v + margin_px + kGrain_px - 1) / kGrain_px * kGrain_px);
  };
  const int x0 = down(win.x0), y0 = down(win.y0);
  return {x0, y0, up(win.x0 + win.w, width_px) - x0, up(win.y0 + win.h, height_px) - y0};
}

Camera window_camera(Camera camera, const PixelWindow& win) {
  camera.cx -= win.x0;
  camera.cy -= win.y0;
  camera.width_px = win.w;
  camera.height_px = win.h;
  return camera;
}

ViewMasks cropped(ViewMasks masks, const PixelWindow& win) {
  for (std::vector<float>& target : masks.target) target = cropped(target, masks.width_px, 1, win);
  if (!masks.known.empty()) masks.known = cropped(masks.known, masks.width_px, 1, win);
  masks.width_px = win.w;
  masks.height_px = win.h;
  return masks;
}

}  // namespace ngs
