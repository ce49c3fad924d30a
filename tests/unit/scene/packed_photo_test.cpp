#include "ngs/scene/packed_photo.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace ngs;

TEST_CASE("colours of 8 bits are packed without loss, others stay floats") {
  ImageF photo(16, 16, 3);
  for (std::size_t i = 0; i < photo.data.size(); ++i) photo.data[i] = float(i % 256) * (1 / 255.f);
  const PackedPhoto packed(photo);
  CHECK(packed.bytes() == photo.data.size());
  CHECK(packed.rgb().data == photo.data);
  ImageF other(4, 4, 3);
  packed.rgb(other);  // of another size before
  CHECK(other.width_px == 16);
  CHECK(other.data == photo.data);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float colour : {std::nextafter(1 / 255.f, 1.f), 0.5f, -1 / 255.f, 1.5f, kNan}) {
    photo.data[100] = colour;
    const PackedPhoto exact(photo);
    CHECK(exact.bytes() == photo.data.size() * sizeof(float));
    CHECK((exact.rgb().data[100] == colour || std::isnan(colour)));
  }
  CHECK(PackedPhoto(ImageF()).empty());
}
