#include "ngs/interactive/live_mask.h"

#include <algorithm>
#include <cstdlib>

#include "ngs/cut/masks/mask_consensus.h"
#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/metrics.h"

namespace ngs::live {
namespace {

constexpr int kSmallSide_px = 112;  // longer side of the image in which the first cut is found
constexpr int kSmallCuts = 4;
constexpr int kBand_px = 3;  // around the contour found at half the size
constexpr int kMargin_px = 6;
constexpr double kSpeck = 0.01;

/// The sizes from small to full, each at most twice the one before.
std::vector<int> longer_sides(int full) {
  std::vector<int> sides{full};
  while (sides.back() > kSmallSide_px) sides.push_back((sides.back() + 1) / 2);
  std::reverse(sides.begin(), sides.end());
  return sides;
}

/// Rows or columns of the large image that make up row or column i of the small one.
struct Span {
  int begin, end;
  Span(int i, int small, int large) : begin(i * large / small), end(std::max(begin + 1, (i + 1) * large / small)) {}
};

/// Mean over a part of the image, rounded.
std::uint8_t mean_value(const ImageU8& picture, const Span& rows, const Span& columns, int channel) {
  int sum = 0;
  for (int v = rows.begin; v < rows.end; ++v)
    for (int u = columns.begin; u < columns.end; ++u) sum += picture.at(u, v, channel);
  const int count = (rows.end - rows.begin) * (columns.end - columns.begin);
  return std::uint8_t((sum + count / 2) / count);
}

ImageU8 smaller(const ImageU8& picture, int width_px, int height_px) {
  ImageU8 out(width_px, height_px, 3);
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = mean_value(picture, {y, height_px, picture.height_px}, {x, width_px, picture.width_px}, c);
  return out;
}

/// One certain pixel decides the reduced pixel, because strokes are thin, unless both sides have certain pixels.
PixelHint hint_of(const int (&count)[4]) {
  const int object = count[int(PixelHint::kObject)], background = count[int(PixelHint::kBackground)];
  if (object > 0 && background == 0) return PixelHint::kObject;
  if (background > 0 && object == 0) return PixelHint::kBackground;
  const bool likelier =
      object + count[int(PixelHint::kLikelyObject)] > background + count[int(PixelHint::kLikelyBackground)];
  return likelier ? PixelHint::kLikelyObject : PixelHint::kLikelyBackground;
}

ViewPrompt smaller(const ViewPrompt& prompt, int width_px, int height_px) {
  ViewPrompt out{width_px, height_px, {}, prompt.by_hand};
  out.hint.reserve(std::size_t(width_px) * std::size_t(height_px));
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const Span rows(y, height_px, prompt.height_px), columns(x, width_px, prompt.width_px);
      int count[4] = {};
      for (int v = rows.begin; v < rows.end; ++v)
        for (int u = columns.begin; u < columns.end; ++u)
          ++count[int(prompt.hint[std::size_t(v) * std::size_t(prompt.width_px) + std::size_t(u)])];
      out.hint.push_back(hint_of(count));
    }
  return out;
}

/// Restricts the free pixels to a band around the contour found at a smaller size; all others become certain.
void narrow(const PixelMask& found, int found_width_px, int found_height_px, ViewPrompt& prompt) {
  const int w = prompt.width_px, h = prompt.height_px;
  PixelMask side(prompt.hint.size());
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      side[std::size_t(y) * std::size_t(w) + std::size_t(x)] =
          found[std::size_t(y * found_height_px / h) * std::size_t(found_width_px) +
                std::size_t(x * found_width_px / w)];
  const std::vector<std::int32_t> distance = signed_distance({side.data(), w, h});
  for (std::size_t p = 0; p < side.size(); ++p) {
    if (is_certain(prompt.hint[p])) continue;
    const bool in_band = std::abs(distance[p]) <= kBand_px;
    prompt.hint[p] = side[p] ? (in_band ? PixelHint::kLikelyObject : PixelHint::kObject)
                             : (in_band ? PixelHint::kLikelyBackground : PixelHint::kBackground);
  }
}

}  // namespace

bool fill_surrounded(ViewPrompt& prompt) {
  const int w = prompt.width_px, h = prompt.height_px;
  PixelMask free(prompt.hint.size());
  for (std::size_t p = 0; p < free.size(); ++p) free[p] = prompt.hint[p] != PixelHint::kBackground;
  const ConnectedComponents pieces = connected_components({free.data(), w, h});
  std::vector<std::uint8_t> open(pieces.size.size()), has_object(pieces.size.size());
  for (std::size_t p = 0; p < free.size(); ++p) {
    if (!free[p]) continue;
    const int x = int(p % std::size_t(w)), y = int(p / std::size_t(w));
    const auto piece = std::size_t(pieces.component[p]);
    open[piece] |= x == 0 || y == 0 || x == w - 1 || y == h - 1;
    has_object[piece] |= prompt.hint[p] == PixelHint::kObject;
  }
  PixelMask surrounded(free.size());
  bool any = false, elsewhere = false;
  for (std::size_t p = 0; p < free.size(); ++p) {
    if (!free[p]) continue;
    const auto piece = std::size_t(pieces.component[p]);
    surrounded[p] = !open[piece] && has_object[piece];
    any |= surrounded[p] != 0;
    elsewhere |= has_object[piece] && open[piece];
  }
  if (!any || elsewhere) return false;
  for (std::size_t p = 0; p < free.size(); ++p)
    if (!is_certain(prompt.hint[p])) prompt.hint[p] = surrounded[p] ? PixelHint::kLikelyObject : PixelHint::kBackground;
  return true;
}

PixelMask live_mask(const ImageU8& picture, const ViewPrompt& prompt, std::uint64_t seed) {
  return live_mask(picture, prompt, side_colours(picture, prompt, kColourSamples), seed);
}

PixelMask live_mask(const ImageU8& picture, const ViewPrompt& prompt, const SideColours& colours, std::uint64_t seed) {
  PixelMask mask;
  int width_px = 0, height_px = 0;
  const int full = std::max(prompt.width_px, prompt.height_px);
  if (std::find(prompt.hint.begin(), prompt.hint.end(), PixelHint::kObject) == prompt.hint.end())
    return PixelMask(prompt.hint.size());
  for (const int side : longer_sides(full)) {
    const int w = std::max(1, prompt.width_px * side / full), h = std::max(1, prompt.height_px * side / full);
    ViewPrompt here = side == full ? prompt : smaller(prompt, w, h);
    const bool first = mask.empty();
    if (!first) narrow(mask, width_px, height_px, here);
    const GrabCutOptions cut{first ? kSmallCuts : 1, kMargin_px, seed};
    mask = grab_cut(side == full ? picture : smaller(picture, w, h), here, cut, colours);
    width_px = w;
    height_px = h;
  }
  return keep_seeded_pieces(prompt, std::move(mask), kSpeck);
}

}  // namespace ngs::live
