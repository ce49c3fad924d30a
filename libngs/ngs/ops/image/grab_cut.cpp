#include "ngs/ops/image/grab_cut.h"

#include <algorithm>

#include "ngs/core/check.h"

namespace ngs {
namespace {

constexpr int kMaxSamples = 1 << 15;  // per side; more do not change a mixture of five

using Colours = std::vector<std::array<std::uint8_t, 3>>;

struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The part of the image that can change, with a margin.
Rectangle region_of_interest(const ViewPrompt& prompt, int margin_px) {
  int left = prompt.width_px, right = -1, top = prompt.height_px, bottom = -1;
  for (int y = 0; y < prompt.height_px; ++y)
    for (int x = 0; x < prompt.width_px; ++x) {
      if (prompt.hint[std::size_t(y) * std::size_t(prompt.width_px) + std::size_t(x)] == PixelHint::kBackground)
        continue;
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
    }
  if (right < 0) return {};
  left = std::max(0, left - margin_px), top = std::max(0, top - margin_px);
  right = std::min(prompt.width_px - 1, right + margin_px), bottom = std::min(prompt.height_px - 1, bottom + margin_px);
  return {left, top, right - left + 1, bottom - top + 1};
}

struct Source {
  const ImageU8& photo;
  const ViewPrompt& prompt;
  Rectangle region;
};

/// Sample colours of one side for its mixture: the certain pixels; if they are too few, the likely ones too.
Colours samples_of(const Source& from, bool object, std::size_t max_samples) {
  Colours samples;
  for (const bool likely_too : {false, true}) {
    samples.clear();
    for (int y = from.region.y; y < from.region.y + from.region.height; ++y)
      for (int x = from.region.x; x < from.region.x + from.region.width; ++x) {
        const PixelHint hint = from.prompt.hint[std::size_t(y) * std::size_t(from.prompt.width_px) + std::size_t(x)];
        if (is_object(hint) == object && (likely_too || is_certain(hint)))
          samples.push_back({from.photo.at(x, y, 0), from.photo.at(x, y, 1), from.photo.at(x, y, 2)});
      }
    if (samples.size() >= kMixtureComponents) break;
  }
  if (samples.size() <= max_samples) return samples;
  Colours fewer(max_samples);
  for (std::size_t i = 0; i < max_samples; ++i) fewer[i] = samples[i * samples.size() / max_samples];
  return fewer;
}

SideColours colours_in(const Source& from, int max_samples) {
  return {samples_of(from, true, std::size_t(max_samples)), samples_of(from, false, std::size_t(max_samples))};
}

void check(const ImageU8& photo, const ViewPrompt& prompt) {
  NGS_CHECK(photo.channels == 3 && photo.width_px == prompt.width_px && photo.height_px == prompt.height_px &&
                prompt.hint.size() == std::size_t(photo.pixels()),
            "GrabCut needs an RGB photo of the prompt's size");
}

PixelMask cut_in(const Source& from, const GrabCutOptions& options, const SideColours& known) {
  const ImageU8& photo = from.photo;
  const ViewPrompt& prompt = from.prompt;
  PixelMask mask(prompt.hint.size());
  for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = is_object(prompt.hint[p]);
  if (from.region.width == 0 || known.background.size() < kMixtureComponents ||
      known.object.size() < kMixtureComponents)
    return mask;

  HintedRegion region{from.region.width, from.region.height, {}, {}};
  const auto for_each_pixel = [&](const auto& work) {
    for (int y = from.region.y; y < from.region.y + from.region.height; ++y)
      for (int x = from.region.x; x < from.region.x + from.region.width; ++x)
        work(x, y, std::size_t(y) * std::size_t(photo.width_px) + std::size_t(x));
  };
  for_each_pixel([&](int x, int y, std::size_t p) {
    region.colour.push_back({photo.at(x, y, 0), photo.at(x, y, 1), photo.at(x, y, 2)});
    region.hint.push_back(prompt.hint[p]);
  });
  colour_cut(region, known, options.iterations, options.seed);
  std::size_t next = 0;
  for_each_pixel([&](int, int, std::size_t p) { mask[p] = is_object(region.hint[next++]); });
  return mask;
}

}  // namespace

PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options) {
  check(photo, prompt);
  const Source from{photo, prompt, region_of_interest(prompt, options.margin_px)};
  return cut_in(from, options, colours_in(from, kMaxSamples));
}

SideColours side_colours(const ImageU8& photo, const ViewPrompt& prompt, int max_samples) {
  check(photo, prompt);
  return colours_in({photo, prompt, {0, 0, photo.width_px, photo.height_px}}, max_samples);
}

PixelMask grab_cut(const ImageU8& photo, const ViewPrompt& prompt, const GrabCutOptions& options,
                   const SideColours& colours) {
  check(photo, prompt);
  return cut_in({photo, prompt, region_of_interest(prompt, options.margin_px)}, options, colours);
}

}  // namespace ngs
