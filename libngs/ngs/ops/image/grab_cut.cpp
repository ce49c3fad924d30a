#include "ngs/ops/image/grab_cut.h"

#include "ngs/core/check.h"
#include "ngs/ops/image/pixel_window.h"

namespace ngs {
namespace {

constexpr int kMaxSamples = 1 << 15;  // per side; more do not change a mixture of five

using Colours = std::vector<std::array<std::uint8_t, 3>>;

/// The part of the image that can change, with a margin.
PixelWindow region_of_interest(const ViewPrompt& prompt, int margin_px) {
  const auto can_change = [&](std::size_t p) { return prompt.hint[p] != PixelHint::kBackground; };
  return window_about(box_where(prompt.width_px, prompt.height_px, can_change), margin_px, prompt.width_px,
                      prompt.height_px);
}

struct Source {
  const ImageU8& photo;
  const ViewPrompt& prompt;
  PixelWindow region;

  /// Calls work(x, y, index) for the pixels of the region.
  template <class Work>
  void for_each_pixel(const Work& work) const {
    for (int y = region.y0; y < region.y0 + region.h; ++y)
      for (int x = region.x0; x < region.x0 + region.w; ++x)
        work(x, y, std::size_t(y) * std::size_t(photo.width_px) + std::size_t(x));
  }
};

/// Sample colours of one side for its mixture: the certain pixels; if they are too few, the likely ones too.
Colours samples_of(const Source& from, bool object, std::size_t max_samples) {
  Colours samples;
  for (const bool likely_too : {false, true}) {
    samples.clear();
    from.for_each_pixel([&](int x, int y, std::size_t p) {
      const PixelHint hint = from.prompt.hint[p];
      if (is_object(hint) == object && (likely_too || is_certain(hint)))
        samples.push_back({from.photo.at(x, y, 0), from.photo.at(x, y, 1), from.photo.at(x, y, 2)});
    });
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
  if (from.region.w == 0 || known.background.size() < kMixtureComponents || known.object.size() < kMixtureComponents)
    return mask;

  HintedRegion region{from.region.w, from.region.h, {}, {}};
  from.for_each_pixel([&](int x, int y, std::size_t p) {
    region.colour.push_back({photo.at(x, y, 0), photo.at(x, y, 1), photo.at(x, y, 2)});
    region.hint.push_back(prompt.hint[p]);
  });
  colour_cut(region, known, options.iterations, options.seed);
  std::size_t next = 0;
  from.for_each_pixel([&](int, int, std::size_t p) { mask[p] = is_object(region.hint[next++]); });
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
