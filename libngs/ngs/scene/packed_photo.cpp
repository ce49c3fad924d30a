#include "ngs/scene/packed_photo.h"

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

template <class T>
ImageF rgb_of(const Image<T>& samples, Vec3<float> background) {
  const std::size_t stride = std::size_t(samples.channels), green = stride > 1 ? 1 : 0, blue = 2 * green;
  constexpr float scale = 1.f / float(std::numeric_limits<T>::max());
  ImageF out(samples.width_px, samples.height_px, 3);
  const T* sample = samples.data.data();
  for (std::size_t i = 0; i < out.data.size(); i += 3, sample += stride) {
    out.data[i] = float(sample[0]) * scale;
    out.data[i + 1] = float(sample[green]) * scale;
    out.data[i + 2] = float(sample[blue]) * scale;
    if (stride == 4) blend_over(&out.data[i], float(sample[3]) * scale, background);
  }
  return out;
}

}  // namespace

int PackedPhoto::width_px() const {
  return std::visit([](const auto& image) { return image.width_px; }, samples_);
}

int PackedPhoto::height_px() const {
  return std::visit([](const auto& image) { return image.height_px; }, samples_);
}

std::size_t PackedPhoto::bytes() const {
  return std::visit([]<class T>(const Image<T>& image) { return image.data.size() * sizeof(T); }, samples_);
}

ImageF PackedPhoto::rgb() const {
  return std::visit(
      [&]<class T>(const Image<T>& image) {
        if constexpr (std::is_same_v<T, float>)
          return image;
        else
          return rgb_of(image, background_);
      },
      samples_);
}

}  // namespace ngs
