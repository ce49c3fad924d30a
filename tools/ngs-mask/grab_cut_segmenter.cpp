#include <algorithm>
#include <cmath>

#include "ngs/backend/for_each.h"
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

struct WindowCut {
  int side_px;
  const GrabCutOptions& cut;
};

/// Cuts overlapping windows, each with the colours around it: a dark foot is object although the room is
/// dark. Every pixel takes the mean of its windows, weighted by how central it is; `whole` votes where a
/// window has no say.
PixelMask cut_windows(const Exec& exec, const ImageU8& photo, const ViewPrompt& prompt, const WindowCut& how,
                      const PixelMask& whole) {
  const int window_px = how.side_px;
  struct Piece {
    Window window;
    int left, top;  // of its tent, which may begin outside of the photo
    PixelMask cut;  // empty: not worth it
  };
  std::vector<Piece> pieces;
  const int step = std::max(1, window_px / 2);
  for (int top = -step; top < photo.height_px; top += step)
    for (int left = -step; left < photo.width_px; left += step)
      pieces.push_back(
          {{std::max(0, left), std::max(0, top), std::min(photo.width_px, left + window_px) - std::max(0, left),
            std::min(photo.height_px, top + window_px) - std::max(0, top)},
           left,
           top,
           {}});
  for_each_task(exec, std::int64_t(pieces.size()), [&](std::int64_t i) {
    Piece& piece = pieces[std::size_t(i)];
    const ViewPrompt mine = cropped(prompt, piece.window);
    if (is_worth_it(mine)) piece.cut = grab_cut(cropped(photo, piece.window), mine, how.cut);
  });
  std::vector<float> votes(std::size_t(photo.pixels())), weights(votes.size());
  for (const auto& [w, left, top, cut] : pieces) {
    if (cut.empty()) continue;
    for (int y = 0; y < w.height; ++y)
      for (int x = 0; x < w.width; ++x) {
        const auto tent = [&](int i) { return 1 - std::abs(2 * (float(i) + 0.5f) / float(window_px) - 1); };
        const float weight = tent(w.left + x - left) * tent(w.top + y - top);
        const std::size_t p = std::size_t(w.top + y) * std::size_t(photo.width_px) + std::size_t(w.left + x);
        votes[p] += weight * float(cut[std::size_t(y) * std::size_t(w.width) + std::size_t(x)]), weights[p] += weight;
      }
  }
  PixelMask mask = whole;
  for (std::size_t p = 0; p < votes.size(); ++p)
    if (weights[p] > 0) mask[p] = votes[p] > 0.5f * weights[p];
  return mask;
}

/// The object's box and `share` of its size on every side; the whole picture where nothing is expected.
Window surroundings(const ViewPrompt& prompt, double share) {
  const std::array<int, 4> box = object_box(prompt);
  if (box[2] == 0) return {0, 0, prompt.width_px, prompt.height_px};
  const int pad = std::max(kLeastWindow, int(std::lround(share * std::max(box[2] - box[0], box[3] - box[1]))));
  const int left = std::max(0, box[0] - pad), top = std::max(0, box[1] - pad);
  return {left, top, std::min(prompt.width_px, box[2] + pad) - left, std::min(prompt.height_px, box[3] + pad) - top};
}

/// The mask of a crop on the picture that it is of; background elsewhere.
PixelMask pasted(const PixelMask& crop, const Window& w, int width_px, int height_px) {
  PixelMask mask(std::size_t(width_px) * std::size_t(height_px));
  for (int y = 0; y < w.height; ++y)
    std::copy_n(crop.begin() + std::int64_t(y) * w.width, w.width,
                mask.begin() + std::int64_t(w.top + y) * width_px + w.left);
  return mask;
}

PixelMask cut_view(const Exec& exec, const SegmenterOptions& options, const ImageU8& photo, const ViewPrompt& prompt,
                   const GrabCutOptions& cut) {
  PixelMask mask = grab_cut(photo, prompt, cut);
  if (options.window > 0) {
    const std::array<int, 4> box = object_box(prompt);
    const double size = std::sqrt(double(box[2] - box[0]) * double(box[3] - box[1]));
    mask =
        cut_windows(exec, photo, prompt, {std::max(kLeastWindow, int(std::lround(options.window * size))), cut}, mask);
  }
  return keep_seeded_pieces(prompt, std::move(mask), options.speck);
}

}  // namespace

Segmenter grab_cut_segmenter(const SegmenterOptions& options, PhotoLoader load, const Exec& exec, std::uint64_t seed) {
  return [options, load = std::move(load), exec, seed](std::size_t view, const ViewPrompt& prompt) {
    GrabCutOptions cut;
    cut.seed = seed;
    cut.iterations = prompt.by_hand ? std::max(5, options.iterations) : options.iterations;
    const ImageU8 photo = load(view);
    if (options.surround <= 0 || prompt.by_hand) return cut_view(exec, options, photo, prompt, cut);
    const Window near = surroundings(prompt, options.surround);
    const PixelMask mask = cut_view(exec, options, cropped(photo, near), cropped(prompt, near), cut);
    return pasted(mask, near, prompt.width_px, prompt.height_px);
  };
}

}  // namespace ngs::cli
