#include "ngs/stages/live/correction.h"

#include <algorithm>

#include "ngs/ops/image/connected_components.h"
#include "ngs/ops/image/metrics.h"

namespace ngs::live {
namespace {

/// Distance of every pixel from the strokes of one side that contradict what the other views say.
std::vector<std::int32_t> distance_of_contest(const ViewPrompt& strokes, const ViewPrompt& prompt, bool object) {
  PixelMask calm(prompt.hint.size(), 1);
  for (std::size_t p = 0; p < calm.size(); ++p)
    if (is_certain(strokes.hint[p]) && is_object(strokes.hint[p]) == object && is_object(prompt.hint[p]) != object)
      calm[p] = 0;
  return chessboard_distance({calm.data(), prompt.width_px, prompt.height_px}, Outside::kUnknown);
}

/// Which pixels of `changed` are connected, through others of it, to a stroke of that side.
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

void lay_strokes(const ViewPrompt& strokes, int contested_px, ViewPrompt& prompt) {
  const auto to_object = distance_of_contest(strokes, prompt, true),
             to_background = distance_of_contest(strokes, prompt, false);
  for (std::size_t p = 0; p < prompt.hint.size(); ++p) {
    if (is_object(prompt.hint[p]) && to_background[p] <= contested_px) prompt.hint[p] = PixelHint::kLikelyObject;
    if (!is_object(prompt.hint[p]) && to_object[p] <= contested_px) prompt.hint[p] = PixelHint::kLikelyBackground;
    if (is_certain(strokes.hint[p])) prompt.hint[p] = strokes.hint[p];
  }
}

ViewPrompt Correction::prompt(int reach_px) const {
  PixelMask calm(before.size());
  for (std::size_t p = 0; p < calm.size(); ++p) calm[p] = !is_certain(added.hint[p]);
  const auto distance = chessboard_distance({calm.data(), strokes.width_px, strokes.height_px}, Outside::kUnknown);
  ViewPrompt prompt = strokes;
  for (std::size_t p = 0; p < calm.size(); ++p) {
    if (is_certain(strokes.hint[p])) continue;
    const bool near = distance[p] <= reach_px;
    prompt.hint[p] = before[p] ? (near ? PixelHint::kLikelyObject : PixelHint::kObject)
                               : (near ? PixelHint::kLikelyBackground : PixelHint::kBackground);
  }
  return prompt;
}

SideColours Correction::colours(const ImageU8& picture, int most) const {
  SideColours marked = side_colours(picture, strokes, most);
  ViewPrompt rest = strokes;
  std::size_t free = 0;
  for (std::size_t p = 0; p < before.size(); ++p) {
    rest.hint[p] = before[p] || is_certain(strokes.hint[p]) ? PixelHint::kLikelyObject : PixelHint::kBackground;
    free += rest.hint[p] == PixelHint::kBackground;
  }
  if (free == 0) return marked;
  const auto drawn = std::ranges::count(strokes.hint, PixelHint::kBackground);
  if (drawn == 0) marked.background.clear();
  const int share = drawn == 0 ? most : int(marked.background.size());
  const SideColours others = side_colours(picture, rest, share);
  marked.background.insert(marked.background.end(), others.background.begin(), others.background.end());
  return marked;
}

PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes) {
  PixelMask more(before.size()), less(before.size()), out = before;
  for (std::size_t p = 0; p < before.size(); ++p) more[p] = found[p] && !before[p], less[p] = before[p] && !found[p];
  more = reached(more, strokes, PixelHint::kObject), less = reached(less, strokes, PixelHint::kBackground);
  for (std::size_t p = 0; p < out.size(); ++p)
    if (more[p] || less[p]) out[p] = more[p];
  return out;
}

}  // namespace ngs::live
