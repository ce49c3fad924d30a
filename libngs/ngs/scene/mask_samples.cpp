#include "ngs/scene/mask_samples.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <numeric>

namespace ngs {
namespace {

using Colour = std::array<std::uint16_t, 3>;

/// Whether a pixel has this colour, within the tolerance of JPEG compression.
bool is_like(const MaskSamples& samples, const std::uint16_t* rgb, const Colour& colour) {
  int most = 0;
  for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(int(rgb[c]) - int(colour[c])));
  return most >> (samples.bits - 8) <= 8;
}

/// The colour around a cut-out: the most frequent one of the border if half of the border has it, else black.
Colour ground_of(const MaskSamples& samples) {
  const std::size_t w = std::size_t(samples.width_px), h = std::size_t(samples.height_px);
  std::vector<Colour> border;
  const auto add = [&](std::size_t x, std::size_t y) {
    const std::uint16_t* rgb = samples.data.data() + (y * w + x) * std::size_t(samples.channels);
    border.push_back({rgb[0], rgb[1], rgb[2]});
  };
  for (std::size_t x = 0; x < w; ++x) {
    add(x, 0);
    add(x, h - 1);
  }
  for (std::size_t y = 0; y < h; ++y) {
    add(0, y);
    add(w - 1, y);
  }
  std::ranges::sort(border);
  Colour ground{};
  std::size_t most = 0;
  for (std::size_t i = 0, next = 0; i < border.size(); i = next) {
    while (next < border.size() && border[next] == border[i]) ++next;
    if (next - i > most) {
      most = next - i;
      ground = border[i];
    }
  }
  const auto like = [&](const Colour& colour) { return is_like(samples, colour.data(), ground); };
  return 2 * std::size_t(std::ranges::count_if(border, like)) >= border.size() ? ground : Colour{};
}

/// The widest channel of a picture of two pure colours, such as red on white, whose max(R, G, B) is the same
/// everywhere; -1: it differs, or there are more colours.
int channel_of_two_colours(const MaskSamples& samples) {
  const int full = (1 << samples.bits) - 1;
  const std::size_t channels = std::size_t(samples.channels), pixels = samples.data.size() / channels;
  if (channels < 3 || pixels == 0) return -1;
  const auto value = [&](std::size_t pixel, std::size_t c) {
    const std::uint16_t* rgb = samples.data.data() + pixel * channels;
    return c < 3 ? int(rgb[c]) : int(std::max({rgb[0], rgb[1], rgb[2]}));
  };
  std::size_t least[4] = {}, most[4] = {};  // pixels
  const auto range = [&](std::size_t c) { return value(most[c], c) - value(least[c], c); };
  for (std::size_t p = 0; p < pixels; ++p) {
    for (std::size_t c = 0; c < 4; ++c) {
      if (value(p, c) < value(least[c], c)) least[c] = p;
      if (value(p, c) > value(most[c], c)) most[c] = p;
    }
    if (range(3) > full / 4) return -1;  // most masks return here, after a few pixels
  }
  std::size_t widest = range(1) >= range(0) ? 1 : 0;  // green on red, as in marked pictures
  if (range(2) > range(widest)) widest = 2;
  if (range(widest) < full / 2) return -1;
  std::size_t others = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    const auto is_like = [&](std::size_t q) {
      return std::ranges::all_of(std::array<std::size_t, 3>{0, 1, 2},
                                 [&](std::size_t c) { return std::abs(value(p, c) - value(q, c)) <= full / 4; });
    };
    others += !is_like(least[widest]) && !is_like(most[widest]);
  }
  return 20 * others > pixels ? -1 : int(widest);
}

struct ColourCounts {
  std::vector<std::size_t> of = std::vector<std::size_t>(std::size_t(1) << 12);  // pixels by colour, 4 bits per channel
  std::size_t ground = 0;                                                        // pixels, not counted by colour
};

ColourCounts count_colours(const MaskSamples& samples) {
  ColourCounts counts;
  const Colour colour_of_ground = ground_of(samples);
  for (std::size_t i = 0; i < samples.data.size(); i += std::size_t(samples.channels)) {
    const std::uint16_t* rgb = samples.data.data() + i;
    std::size_t colour = 0;
    for (int c = 0; c < 3; ++c) colour = 16 * colour + std::size_t(rgb[c] >> (samples.bits - 4));
    const bool is_ground = is_like(samples, rgb, colour_of_ground);
    counts.ground += is_ground;
    counts.of[colour] += !is_ground;
  }
  return counts;
}

}  // namespace

bool is_cut_out(const MaskSamples& samples) {
  for (std::size_t i = 3; samples.channels == 4 && i < samples.data.size(); i += 4)
    if (samples.data[i] != samples.data[3]) return true;
  return false;
}

bool is_grey(const MaskSamples& samples) {
  const std::size_t channels = std::size_t(samples.channels);
  for (std::size_t i = 0; channels >= 3 && i < samples.data.size(); i += channels)
    if (samples.data[i] != samples.data[i + 1] || samples.data[i] != samples.data[i + 2]) return false;
  return true;
}

ImageKind image_kind(const MaskSamples& samples) {
  constexpr std::size_t kFlatColours = 12;  // number of colours of a mask, in steps of 1/16
  // Share of the kFlatColours most frequent colours in the non-background pixels. Photos: 0.29 to 0.87 in six captures,
  // some of each below 0.78. JPEG masks of two colours: 0.87 to 0.99, on black 0.95 to 0.99.
  constexpr double kFlat = 0.8, kFlatOnOneColour = 0.94;
  constexpr double kGround = 0.05;  // minimum share of background pixels for kPhotoOnOneColour
  if (samples.channels < 3 || is_cut_out(samples) || is_grey(samples)) return ImageKind::kMask;
  auto [counts, ground] = count_colours(samples);
  const std::size_t all = samples.data.size() / std::size_t(samples.channels);
  std::ranges::sort(counts, std::greater<>());
  const std::size_t flat = std::accumulate(counts.begin(), counts.begin() + kFlatColours, std::size_t(0));
  const bool on_one_colour = double(ground) >= kGround * double(all);
  if (double(flat) >= (on_one_colour ? kFlatOnOneColour : kFlat) * double(all - ground)) return ImageKind::kMask;
  return on_one_colour ? ImageKind::kPhotoOnOneColour : ImageKind::kPhoto;
}

bool has_several_colours(const MaskSamples& samples) {
  constexpr double kLeast = 0.05;  // minimum share of a common colour in the non-background pixels
  constexpr int kSame = 3;         // largest difference of equal colours, steps of 1/16
  const ColourCounts counts = count_colours(samples);
  const std::size_t others = samples.data.size() / std::size_t(samples.channels) - counts.ground;
  int least[3] = {16, 16, 16}, most[3] = {};  // of the common colours
  for (std::size_t colour = 0; colour < counts.of.size(); ++colour)
    if (double(counts.of[colour]) > kLeast * double(others))
      for (std::size_t c = 0; c < 3; ++c) {
        const int level = int(colour >> (4 * c)) & 15;
        least[c] = std::min(least[c], level);
        most[c] = std::max(most[c], level);
      }
  return std::ranges::any_of(std::array<std::size_t, 3>{0, 1, 2},
                             [&](std::size_t c) { return most[c] - least[c] > kSame; });
}

bool has_many_greys(const MaskSamples& samples) {
  // Share of all pixels in the three most frequent of 16 grey levels. Grey photos: 0.32 to 0.88 in five captures; depth
  // map of a plane: 0.2; masks: 1.
  constexpr double kFlat = 0.8;
  std::array<std::size_t, 16> counts{};
  for (std::size_t i = 0; i < samples.data.size(); i += std::size_t(samples.channels))
    ++counts[std::size_t(samples.data[i] >> (samples.bits - 4))];
  std::ranges::sort(counts, std::greater<>());
  const std::size_t flat = counts[0] + counts[1] + counts[2];
  return double(flat * std::size_t(samples.channels)) < kFlat * double(samples.data.size());
}

DecisiveSamples decisive_samples(const MaskSamples& samples) {
  const std::size_t channels = std::size_t(samples.channels);
  const bool cut_out = is_cut_out(samples), on_one_colour = image_kind(samples) == ImageKind::kPhotoOnOneColour;
  const Colour ground = on_one_colour ? ground_of(samples) : Colour{};
  const int widest = cut_out || on_one_colour ? -1 : channel_of_two_colours(samples);
  DecisiveSamples out{std::vector<std::uint16_t>(samples.data.size() / channels), samples.bits == 8 ? 255.f : 65535.f};
  for (std::size_t i = 0; i < out.value.size(); ++i) {
    const std::uint16_t* sample = samples.data.data() + i * channels;
    std::uint16_t& value = out.value[i];
    value = cut_out ? sample[3] : *std::max_element(sample, sample + std::min<std::size_t>(channels, 3));
    if (widest >= 0) value = sample[widest];
    if (on_one_colour) value = std::uint16_t(is_like(samples, sample, ground) ? 0 : (1 << samples.bits) - 1);
  }
  const std::uint16_t most = out.value.empty() ? std::uint16_t(0) : *std::ranges::max_element(out.value);
  const auto is_8_bit = [](std::uint16_t v) { return v == 0 || v == 255; };
  if (most == 1) out.full_scale = 1;
  if (most == 255 && std::ranges::all_of(out.value, is_8_bit)) out.full_scale = 255;
  return out;
}

std::vector<std::uint8_t> object_pixels(const MaskSamples& samples) {
  const DecisiveSamples decisive = decisive_samples(samples);
  const float least = decisive.full_scale * (128.f / 255.f);
  std::vector<std::uint8_t> object(decisive.value.size());
  std::ranges::transform(decisive.value, object.begin(), [&](std::uint16_t v) { return float(v) >= least; });
  return object;
}

}  // namespace ngs
