#include "ngs/scene/mask_samples.h"

#include <doctest/doctest.h>

namespace ngs {
namespace {

using Samples = std::vector<std::uint16_t>;
using Bits = std::vector<std::uint8_t>;

MaskSamples row(const Samples& data, int channels, int bits = 8) {
  return {int(data.size()) / channels, 1, channels, bits, data};
}

TEST_CASE("mask samples: any pure colour on black is object") {
  for (std::size_t channel = 0; channel < 3; ++channel) {
    Samples data(6, 0);
    data[channel] = 255;
    CHECK(object_pixels(row(data, 3)) == Bits{1, 0});
    CHECK_FALSE(is_grey(row(data, 3)));
  }
}

TEST_CASE("mask samples: alpha is the mask if and only if it varies") {
  const Samples cut_out = {9, 9, 9, 255, 255, 255, 255, 0}, opaque = {9, 9, 9, 255, 255, 255, 255, 255};
  CHECK(is_cut_out(row(cut_out, 4)));
  CHECK(object_pixels(row(cut_out, 4)) == Bits{1, 0});
  CHECK_FALSE(is_cut_out(row(opaque, 4)));
  CHECK(object_pixels(row(opaque, 4)) == Bits{0, 1});
}

TEST_CASE("mask samples: object is at least 128/255 of full scale, or 1 in a file of zeros and ones") {
  CHECK(object_pixels(row({0, 127, 128, 255}, 1)) == Bits{0, 0, 1, 1});
  CHECK(object_pixels(row({0, 32895, 32896, 65535}, 1, 16)) == Bits{0, 0, 1, 1});
  CHECK(object_pixels(row({0, 1, 1, 0}, 1)) == Bits{0, 1, 1, 0});
  CHECK(object_pixels(row({0, 255, 0}, 1, 16)) == Bits{0, 1, 0});
  CHECK(object_pixels(row({0, 254, 255}, 1, 16)) == Bits{0, 0, 0});
  CHECK(object_pixels(row({0, 0, 0}, 1)) == Bits{0, 0, 0});
  CHECK(is_zero_one(row({0, 1, 0, 0, 0, 0}, 3)));
  CHECK(object_pixels(row({}, 1)).empty());
  CHECK(is_grey(row({3, 7}, 1)));
}

}  // namespace
}  // namespace ngs
