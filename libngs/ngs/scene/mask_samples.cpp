#include "ngs/scene/mask_samples.h"

#include <algorithm>

namespace ngs {
namespace {

std::uint16_t largest(const std::vector<std::uint16_t>& plane) {
  return plane.empty() ? std::uint16_t(0) : *std::max_element(plane.begin(), plane.end());
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

std::vector<std::uint16_t> decisive_channel(const MaskSamples& samples) {
  const std::size_t channels = std::size_t(samples.channels);
  const bool cut_out = is_cut_out(samples);
  std::vector<std::uint16_t> plane(samples.data.size() / channels);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const std::uint16_t* sample = samples.data.data() + i * channels;
    plane[i] = cut_out ? sample[3] : *std::max_element(sample, sample + std::min<std::size_t>(channels, 3));
  }
  return plane;
}

float full_scale(const MaskSamples& samples) {
  const std::vector<std::uint16_t> plane = decisive_channel(samples);
  if (largest(plane) == 1) return 1;
  const auto is_8_bit = [](std::uint16_t v) { return v == 0 || v == 255; };
  if (samples.bits == 8 || (largest(plane) == 255 && std::ranges::all_of(plane, is_8_bit))) return 255;
  return 65535;
}

bool is_zero_one(const MaskSamples& samples) { return full_scale(samples) == 1; }

std::vector<std::uint8_t> object_pixels(const MaskSamples& samples) {
  const std::vector<std::uint16_t> plane = decisive_channel(samples);
  const float least = full_scale(samples) * (128.f / 255.f);
  std::vector<std::uint8_t> object(plane.size());
  for (std::size_t i = 0; i < plane.size(); ++i) object[i] = float(plane[i]) >= least;
  return object;
}

}  // namespace ngs
