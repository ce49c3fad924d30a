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

TEST_CASE("mask samples: of two pure colours the channel that differs most decides, of more colours none") {
  CHECK(object_pixels(row({255, 0, 0, 255, 255, 255}, 3)) == Bits{0, 1});
  CHECK(object_pixels(row({0, 0, 255, 0, 255, 0, 4, 250, 9}, 3)) == Bits{0, 1, 1});
  CHECK(object_pixels(row({0, 0, 255, 0, 255, 0, 255, 0, 0}, 3)) == Bits{1, 1, 1});
}

TEST_CASE("mask samples: alpha is the mask if and only if it varies") {
  const Samples cut_out = {9, 9, 9, 255, 255, 255, 255, 0}, opaque = {9, 9, 9, 255, 255, 255, 255, 255};
  CHECK(is_cut_out(row(cut_out, 4)));
  CHECK(object_pixels(row(cut_out, 4)) == Bits{1, 0});
  CHECK_FALSE(is_cut_out(row(opaque, 4)));
  CHECK(object_pixels(row(opaque, 4)) == Bits{0, 1});
}

TEST_CASE("mask samples: pictures of many colours are told from masks, those on black are masks of what is not black") {
  Samples photo, on_black, colours;
  for (std::uint16_t i = 0; i < 256; ++i) {
    const std::uint16_t red = i, green = std::uint16_t(7 * i % 256), blue = std::uint16_t(19 * i % 256);
    photo.insert(photo.end(), {std::max<std::uint16_t>(red, 9), green, blue});
    on_black.insert(on_black.end(), {i < 128 ? std::uint16_t(0) : red, i < 128 ? std::uint16_t(0) : green, 0});
    colours.insert(colours.end(), {std::uint16_t(20 * (i / 32)), 90, 200});
  }
  CHECK(pictured(row(photo, 3)) == Pictured::kPhoto);
  CHECK(pictured(row(on_black, 3)) == Pictured::kOnBlack);
  CHECK(pictured(row(colours, 3)) == Pictured::kMask);
  Bits object(128, 0);
  object.resize(256, 1);
  CHECK(object_pixels(row(on_black, 3)) == object);
  CHECK(pictured(row({0, 0, 0, 128, 0, 0}, 3)) == Pictured::kMask);
  CHECK(pictured(row({}, 3)) == Pictured::kMask);
}

TEST_CASE("mask samples: object is at least 128/255 of full scale, or 1 in a file of zeros and ones") {
  CHECK(object_pixels(row({0, 127, 128, 255}, 1)) == Bits{0, 0, 1, 1});
  CHECK(object_pixels(row({0, 32895, 32896, 65535}, 1, 16)) == Bits{0, 0, 1, 1});
  CHECK(object_pixels(row({0, 1, 1, 0}, 1)) == Bits{0, 1, 1, 0});
  CHECK(object_pixels(row({0, 255, 0}, 1, 16)) == Bits{0, 1, 0});
  CHECK(object_pixels(row({0, 254, 255}, 1, 16)) == Bits{0, 0, 0});
  CHECK(object_pixels(row({0, 0, 0}, 1)) == Bits{0, 0, 0});
  CHECK(decisive_samples(row({0, 1, 0, 0, 0, 0}, 3)).full_scale == 1);
  CHECK(object_pixels(row({}, 1)).empty());
  CHECK(is_grey(row({3, 7}, 1)));
}

}  // namespace
}  // namespace ngs
