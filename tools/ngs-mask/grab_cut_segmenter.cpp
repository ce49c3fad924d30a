#include <algorithm>
#include <cmath>

#include "ngs/ops/image/grab_cut.h"
#include "segmenters.h"

namespace ngs::cli {

ImageU8 photo_bytes(const ImageF& photo) {
  ImageU8 out(photo.width_px, photo.height_px, photo.channels);
  for (std::size_t i = 0; i < out.data.size(); ++i)
    out.data[i] = std::uint8_t(std::lround(255 * std::clamp(photo.data[i], 0.f, 1.f)));
  return out;
}

namespace {

constexpr int kLeastWindow = 48;            // px
constexpr std::int64_t kLeastCertain = 64;  // pixels per side to learn a window's colours from

struct Window {
  int left, top, width, height;
};

ImageU8 cropped(const ImageU8& image, const Window& w) {
  ImageU8 out(w.width, w.height, image.channels);
  for (int y = 0; y < w.height; ++y)
    std::copy_n(&image.data[image.index(w.left, w.top + y)], w.width * image.channels, &out.data[out.index(0, y)]);
  return out;
}

ViewPrompt cropped(const ViewPrompt& prompt, const Window& w) {
  ViewPrompt out{w.width, w.height, {}, prompt.by_hand};
  for (int y = 0; y < w.height; ++y) {
    const auto row = prompt.hint.begin() + std::int64_t(w.top + y) * prompt.width_px + w.left;
    out.hint.insert(out.hint.end(), row, row + w.width);
  }
  return out;
}

/// Both sides are certain somewhere in the window, and something is not.
bool is_worth_it(const ViewPrompt& prompt) {
  std::int64_t count[4] = {};
  for (const PixelHint hint : prompt.hint) ++count[std::size_t(hint)];
  return std::min(count[0], count[1]) >= kLeastCertain && count[2] + count[3] > 0;
}

/// Cuts overlapping windows, each with the colours around it: a dark foot is object although the room is
/// dark. Every pixel takes the mean of its windows, weighted by how central it is; `whole` votes where a
/// window has no say.
PixelMask cut_windows(const ImageU8& photo, const ViewPrompt& prompt, const PixelMask& whole, int window_px,
                      const GrabCutOptions& options) {
  const auto pixels = std::size_t(photo.pixels());
  std::vector<float> votes(pixels), weights(pixels);
  const int step = std::max(1, window_px / 2);
  for (int top = -step; top < photo.height_px; top += step)
    for (int left = -step; left < photo.width_px; left += step) {
      const Window w{std::max(0, left), std::max(0, top),
                     std::min(photo.width_px, left + window_px) - std::max(0, left),
                     std::min(photo.height_px, top + window_px) - std::max(0, top)};
      const ViewPrompt mine = cropped(prompt, w);
      if (!is_worth_it(mine)) continue;
      const PixelMask cut = grab_cut(cropped(photo, w), mine, options);
      for (int y = 0; y < w.height; ++y)
        for (int x = 0; x < w.width; ++x) {
          const auto tent = [&](int i) { return 1 - std::abs(2 * (float(i) + 0.5f) / float(window_px) - 1); };
          const float weight = tent(w.left + x - left) * tent(w.top + y - top);
          const std::size_t p = std::size_t(w.top + y) * std::size_t(photo.width_px) + std::size_t(w.left + x);
          votes[p] += weight * float(cut[std::size_t(y) * std::size_t(w.width) + std::size_t(x)]), weights[p] += weight;
        }
    }
  PixelMask mask = whole;
  for (std::size_t p = 0; p < pixels; ++p)
    if (weights[p] > 0) mask[p] = votes[p] > 0.5f * weights[p];
  return mask;
}

}  // namespace

Segmenter grab_cut_segmenter(const SegmenterOptions& options, PhotoLoader load, std::uint64_t seed) {
  return [=](std::size_t view, const ViewPrompt& prompt) {
    GrabCutOptions cut;
    cut.seed = seed;
    cut.iterations = prompt.by_hand ? std::max(5, options.iterations) : options.iterations;
    const ImageU8 photo = load(view);
    PixelMask mask = grab_cut(photo, prompt, cut);
    if (options.window > 0) {
      const std::array<int, 4> box = object_box(prompt);
      const double size = std::sqrt(double(box[2] - box[0]) * double(box[3] - box[1]));
      mask = cut_windows(photo, prompt, mask, std::max(kLeastWindow, int(std::lround(options.window * size))), cut);
    }
    return keep_seeded_pieces(prompt, std::move(mask), options.speck);
  };
}

}  // namespace ngs::cli
