#include "ngs/stages/live/correction.h"

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

PixelMask corrected(const PixelMask& before, const PixelMask& found, const ViewPrompt& strokes) {
  PixelMask more(before.size()), less(before.size()), out = before;
  for (std::size_t p = 0; p < before.size(); ++p) more[p] = found[p] && !before[p], less[p] = before[p] && !found[p];
  more = reached(more, strokes, PixelHint::kObject), less = reached(less, strokes, PixelHint::kBackground);
  for (std::size_t p = 0; p < out.size(); ++p)
    if (more[p] || less[p]) out[p] = more[p];
  return out;
}

}  // namespace ngs::live
