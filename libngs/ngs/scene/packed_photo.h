#pragma once
// A photo that waits for its turn: as the samples of its file, which take a quarter (8 bit) or half (16 bit) of the
// floats that stages read, or as floats where it was computed.
#include <cstddef>
#include <utility>
#include <variant>

#include "ngs/math/vec.h"
#include "ngs/scene/views.h"

namespace ngs {

class PackedPhoto {
 public:
  using Samples = std::variant<ImageF, ImageU8, ImageU16>;

  PackedPhoto() = default;
  /// [H, W, 3] RGB in [0, 1].
  PackedPhoto(ImageF rgb) : samples_(std::move(rgb)) {}
  /// [H, W, 1, 3 or 4] as in a file; where pixels are transparent, `behind` shows through.
  PackedPhoto(Samples samples, Vec3<float> behind) : samples_(std::move(samples)), behind_(behind) {}

  bool empty() const { return width_px() == 0; }
  int width_px() const;
  int height_px() const;
  /// What the pixels take.
  std::size_t bytes() const;
  /// [H, W, 3] RGB in [0, 1]; grey is replicated.
  ImageF rgb() const;

 private:
  Samples samples_;
  Vec3<float> behind_{0, 0, 0};
};

}  // namespace ngs
