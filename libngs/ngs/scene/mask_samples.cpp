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

bool is_zero_one(const MaskSamples& samples) { return largest(decisive_channel(samples)) == 1; }

std::vector<std::uint8_t> object_pixels(const MaskSamples& samples) {
  const std::vector<std::uint16_t> plane = decisive_channel(samples);
  const int least = largest(plane) == 1 ? 1 : samples.bits == 16 ? 128 * 257 : 128;
  std::vector<std::uint8_t> object(plane.size());
  for (std::size_t i = 0; i < plane.size(); ++i) object[i] = plane[i] >= least;
  return object;
}

}  // namespace ngs
