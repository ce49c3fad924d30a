#include "ngs/scene/packed_photo.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace ngs {
namespace {

/// Composites a straight (not premultiplied) colour over a background. Must precede resizing: means are then those of
/// premultiplied colours, and colours with alpha 0 do not bleed into other pixels.
void blend_over(float rgb[3], float alpha, Vec3<float> background) {
  const float under[3] = {background.x, background.y, background.z};
  for (int c = 0; c < 3; ++c) rgb[c] = alpha * rgb[c] + (1 - alpha) * under[c];
}

/// A sample v of a file is the colour v * kScale.
template <class T>
constexpr float kScale = 1.f / float(std::numeric_limits<T>::max());

template <class T>
void to_rgb(const Image<T>& samples, Vec3<float> background, ImageF& out) {
  const std::size_t stride = std::size_t(samples.channels), green = stride > 1 ? 1 : 0, blue = 2 * green;
  out.width_px = samples.width_px;
  out.height_px = samples.height_px;
  out.channels = 3;
  out.data.resize(std::size_t(out.pixels()) * 3);
  const T* sample = samples.data.data();
  for (std::size_t i = 0; i < out.data.size(); i += 3, sample += stride) {
    out.data[i] = float(sample[0]) * kScale<T>;
    out.data[i + 1] = float(sample[green]) * kScale<T>;
    out.data[i + 2] = float(sample[blue]) * kScale<T>;
    if (stride == 4) blend_over(&out.data[i], float(sample[3]) * kScale<T>, background);
  }
}

/// The sample of 8 bits whose colour is nearest.
std::uint8_t nearest_sample(float colour) {
  constexpr float kMost = std::numeric_limits<std::uint8_t>::max();
  return colour >= 0 ? std::uint8_t(std::lround(std::min(colour, 1.f) * kMost)) : std::uint8_t(0);  // NaN: 0
}

PackedPhoto::Samples packed(ImageF rgb) {
  const auto is_sample = [](float v) { return float(nearest_sample(v)) * kScale<std::uint8_t> == v; };
  if (rgb.data.empty() || !std::ranges::all_of(rgb.data, is_sample)) return rgb;
  ImageU8 samples(rgb.width_px, rgb.height_px, rgb.channels);
  std::ranges::transform(rgb.data, samples.data.begin(), nearest_sample);
  return samples;
}

}  // namespace

PackedPhoto::PackedPhoto(ImageF rgb) : samples_(packed(std::move(rgb))) {}

int PackedPhoto::width_px() const {
  return std::visit([](const auto& image) { return image.width_px; }, samples_);
}

int PackedPhoto::height_px() const {
  return std::visit([](const auto& image) { return image.height_px; }, samples_);
}

std::size_t PackedPhoto::bytes() const {
  return std::visit([]<class T>(const Image<T>& image) { return image.data.size() * sizeof(T); }, samples_);
}

void PackedPhoto::rgb(ImageF& out) const {
  std::visit(
      [&]<class T>(const Image<T>& image) {
        if constexpr (std::is_same_v<T, float>)
          out = image;
        else
          to_rgb(image, background_, out);
      },
      samples_);
}

ImageF PackedPhoto::rgb() const {
  ImageF out;
  rgb(out);
  return out;
}

}  // namespace ngs
