#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
#include "ngs/ops/image/grab_cut.h"
#include "ngs/ops/image/image_bytes.h"
#include "ngs/ops/image/pixel_window.h"
#include "segmenters.h"

namespace ngs::cli {

namespace {

constexpr int kMinWindow = 48;            // px
constexpr int kCutsByHand = 5;            // iterations for prompts by hand
constexpr double kSpeck = 0.01;           // fraction of the mask: smaller holes are filled
constexpr std::int64_t kMinCertain = 64;  // certain pixels per label to fit a window's colour models

ImageU8 cropped(const ImageU8& image, const PixelWindow& win) {
  ImageU8 out(win.w, win.h, image.channels);
  out.data = ngs::cropped(image.data, image.width_px, image.channels, win);
  return out;
}

ViewPrompt cropped(const ViewPrompt& prompt, const PixelWindow& win) {
  return {win.w, win.h, ngs::cropped(prompt.hint, prompt.width_px, 1, win), prompt.by_hand};
}

/// True if the window has enough certain pixels of both labels, and uncertain pixels.
bool can_be_cut(const ViewPrompt& prompt) {
  std::int64_t count[4] = {};
  for (const PixelHint hint : prompt.hint) ++count[std::size_t(hint)];
  return std::min(count[0], count[1]) >= kMinCertain && count[2] + count[3] > 0;
}

/// A window, its part inside the photo, and the mask of that part.
struct WindowCut {
  int left, top;
  PixelWindow part;
  PixelMask mask = {};  // empty: not segmented
};

std::vector<WindowCut> windows_over(const ImageU8& photo, int window_px) {
  std::vector<WindowCut> cuts;
  const int step = std::max(1, window_px / 2);
  for (int top = -step; top < photo.height_px; top += step)
    for (int left = -step; left < photo.width_px; left += step)
      cuts.push_back(
          {left,
           top,
           {std::max(0, left), std::max(0, top), std::min(photo.width_px, left + window_px) - std::max(0, left),
            std::min(photo.height_px, top + window_px) - std::max(0, top)}});
  return cuts;
}

/// Each pixel gets the mean of its windows, weighted by a tent; pixels without a segmented window keep `whole`.
PixelMask mean_of(const std::vector<WindowCut>& cuts, int window_px, int width_px, PixelMask whole) {
  std::vector<float> votes(whole.size()), weights(whole.size());
  const auto tent = [&](int i) { return 1 - std::abs(2 * (float(i) + 0.5f) / float(window_px) - 1); };
  for (const WindowCut& cut : cuts) {
    const PixelWindow& win = cut.part;
    for (int y = 0; y < win.h && !cut.mask.empty(); ++y)
      for (int x = 0; x < win.w; ++x) {
        const float weight = tent(win.x0 + x - cut.left) * tent(win.y0 + y - cut.top);
        const std::size_t p = std::size_t(win.y0 + y) * std::size_t(width_px) + std::size_t(win.x0 + x);
        votes[p] += weight * float(cut.mask[win.at(x, y)]);
        weights[p] += weight;
      }
  }
  for (std::size_t p = 0; p < whole.size(); ++p)
    if (weights[p] > 0) whole[p] = votes[p] > 0.5f * weights[p];
  return whole;
}

/// Segments the whole photo and, in parallel, overlapping windows (none if window_px is 0) with local colour models:
/// a dark foot can be object in a dark room.
PixelMask cut_windows(const Exec& exec, const ImageU8& photo, const ViewPrompt& prompt, int window_px,
                      const GrabCutOptions& options) {
  std::vector<WindowCut> cuts;
  if (window_px > 0) cuts = windows_over(photo, window_px);
  PixelMask whole;
  for_each_task(exec, std::int64_t(cuts.size()) + 1, [&](std::int64_t i) {
    if (i == 0) {
      whole = grab_cut(photo, prompt, options);
      return;
    }
    WindowCut& cut = cuts[std::size_t(i - 1)];
    const ViewPrompt part = cropped(prompt, cut.part);
    if (can_be_cut(part)) cut.mask = grab_cut(cropped(photo, cut.part), part, options);
  });
  return mean_of(cuts, window_px, photo.width_px, std::move(whole));
}

}  // namespace

Segmenter grab_cut_segmenter(const Exec& exec, const SegmenterOptions& options, PhotoLoader load, std::uint64_t seed) {
  return [=](std::size_t view, const ViewPrompt& prompt) {
    GrabCutOptions cut;
    cut.seed = seed;
    if (prompt.by_hand) cut.iterations = kCutsByHand;
    const ImageU8 photo = load(view);
    int window_px = 0;
    if (options.window > 0) {
      const std::array<int, 4> box = object_box(prompt);
      const double size = std::sqrt(double(box[2] - box[0]) * double(box[3] - box[1]));
      window_px = std::max(kMinWindow, int(std::lround(options.window * size)));
    }
    PixelMask mask = cut_windows(exec, photo, prompt, window_px, cut);
    return keep_seeded_pieces(prompt, std::move(mask), kSpeck);
  };
}

}  // namespace ngs::cli
