#pragma once
// A photo in compact form: file samples take a quarter (8 bit) or half (16 bit) of the memory of the floats that stages
// read. Computed photos are stored as floats, unless all of them are multiples of 1/255.
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
  /// [H, W, 3] RGB in [0, 1]; rgb() returns the same values.
  PackedPhoto(ImageF rgb);
  /// [H, W, 1, 3 or 4] as in a file; transparent pixels are composited over `background`.
  PackedPhoto(Samples samples, Vec3<float> background) : samples_(std::move(samples)), background_(background) {}

  bool empty() const { return width_px() == 0; }
  int width_px() const;
  int height_px() const;
  /// Memory of the samples, bytes.
  std::size_t bytes() const;
  /// [H, W, 3] RGB in [0, 1]; grey is replicated.
  ImageF rgb() const;
  /// The same in the memory of `out`.
  void rgb(ImageF& out) const;

 private:
  Samples samples_;
  Vec3<float> background_{0, 0, 0};
};

}  // namespace ngs
