#include "ngs/interactive/correction.h"

#include <algorithm>
#include <cstdlib>

#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/metrics.h"

namespace ngs::live {
namespace {

/// Pixels of `changed` in a connected component with a stroke of that side.
PixelMask reached(const PixelMask& changed, const ViewPrompt& strokes, PixelHint side) {
  const ConnectedComponents pieces = connected_components({changed.data(), strokes.width_px, strokes.height_px});
  std::vector<std::uint8_t> is_reached(pieces.size.size());
  for (std::size_t p = 0; p < changed.size(); ++p)
    if (changed[p] && strokes.hint[p] == side) is_reached[std::size_t(pieces.component[p])] = 1;
  PixelMask out(changed.size());
  for (std::size_t p = 0; p < changed.size(); ++p) out[p] = changed[p] && is_reached[std::size_t(pieces.component[p])];
  return out;
}

}  // namespace

ViewPrompt Correction::prompt(int reach_px, int band_px) const {
  const int w = strokes.width_px, h = strokes.height_px;
  PixelMask unstroked(before.size());
  for (std::size_t p = 0; p < unstroked.size(); ++p) unstroked[p] = !is_certain(added.hint[p]);
  const auto from_stroke = chessboard_distance({unstroked.data(), w, h}, Outside::kUnknown),
             to_contour = signed_distance({before.data(), w, h});
  if (std::ranges::count(strokes.hint, PixelHint::kObject) == 0) {
    int farthest = 0;
    for (std::size_t p = 0; p < before.size(); ++p)
      if (before[p]) farthest = std::max(farthest, from_stroke[p]);
    reach_px = std::min(reach_px, farthest / 2);
  }
  ViewPrompt prompt = strokes;
  for (std::size_t p = 0; p < unstroked.size(); ++p) {
    if (is_certain(strokes.hint[p])) continue;
    const bool free = from_stroke[p] <= reach_px || std::abs(to_contour[p]) <= band_px;
    prompt.hint[p] = before[p] ? (free ? PixelHint::kLikelyObject : PixelHint::kObject)
                               : (free ? PixelHint::kLikelyBackground : PixelHint::kBackground);
  }
  return prompt;
}

SideColours Correction::colours(const ImageU8& picture, int max_samples) const {
  ViewPrompt rest = strokes;
  for (std::size_t p = 0; p < before.size(); ++p)
    rest.hint[p] = is_certain(strokes.hint[p]) ? PixelHint::kLikelyObject
                   : before[p]                 ? PixelHint::kObject
                                               : PixelHint::kBackground;
  SideColours colours = side_colours(picture, rest, max_samples);
  const SideColours drawn = side_colours(picture, strokes, max_samples);
  const auto balance = [&](PixelHint side, auto& all, const auto& marked) {
    if (std::ranges::count(strokes.hint, side) == 0) return;
    if (std::ranges::count(rest.hint, side) == 0) all.clear();
    all.insert(all.end(), marked.begin(), marked.end());
  };
  balance(PixelHint::kObject, colours.object, drawn.object);
  balance(PixelHint::kBackground, colours.background, drawn.background);
  return colours;
}

PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes) {
  PixelMask more(before.size()), less(before.size()), out = before;
  for (std::size_t p = 0; p < before.size(); ++p) {
    more[p] = found[p] && !before[p];
    less[p] = before[p] && !found[p];
  }
  more = reached(more, strokes, PixelHint::kObject);
  less = reached(less, strokes, PixelHint::kBackground);
  for (std::size_t p = 0; p < out.size(); ++p)
    if (more[p] || less[p]) out[p] = more[p];
  return out;
}

}  // namespace ngs::live
