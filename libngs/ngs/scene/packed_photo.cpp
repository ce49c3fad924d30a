#include "ngs/scene/packed_photo.h"

#include <limits>
#include <type_traits>

namespace ngs {
namespace {

/// A pixel's own colour, not premultiplied, over another one. Before any resizing: the means of what is seen are
/// then those of premultiplied colours, and colours under alpha 0 reach no other pixel.
void lay_over(float rgb[3], float alpha, Vec3<float> behind) {
  const float under[3] = {behind.x, behind.y, behind.z};
  for (int c = 0; c < 3; ++c) rgb[c] = alpha * rgb[c] + (1 - alpha) * under[c];
}

template <class T>
ImageF rgb_of(const Image<T>& samples, Vec3<float> behind) {
  const std::size_t stride = std::size_t(samples.channels), green = stride > 1 ? 1 : 0, blue = 2 * green;
  constexpr float scale = 1.f / float(std::numeric_limits<T>::max());
  ImageF out(samples.width_px, samples.height_px, 3);
  const T* sample = samples.data.data();
  for (std::size_t i = 0; i < out.data.size(); i += 3, sample += stride) {
    out.data[i] = float(sample[0]) * scale;
    out.data[i + 1] = float(sample[green]) * scale;
    out.data[i + 2] = float(sample[blue]) * scale;
    if (stride == 4) lay_over(&out.data[i], float(sample[3]) * scale, behind);
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
          return rgb_of(image, behind_);
      },
      samples_);
}

}  // namespace ngs
