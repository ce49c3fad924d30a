#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "ngs/scene/mask_samples.h"
#include "ngs/scene/mask_threshold.h"
#include "ngs/scene/rle_masks.h"

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
  CHECK(object_pixels(row({255, 0, 0, 0, 255, 0}, 3)) == Bits{0, 1});
  CHECK(object_pixels(row({0, 0, 255, 0, 255, 0, 255, 0, 0}, 3)) == Bits{1, 1, 1});
}

TEST_CASE("mask samples: alpha is the mask if and only if it varies") {
  const Samples cut_out = {9, 9, 9, 255, 255, 255, 255, 0}, opaque = {9, 9, 9, 255, 255, 255, 255, 255};
  CHECK(is_cut_out(row(cut_out, 4)));
  CHECK(object_pixels(row(cut_out, 4)) == Bits{1, 0});
  CHECK_FALSE(is_cut_out(row(opaque, 4)));
  CHECK(object_pixels(row(opaque, 4)) == Bits{0, 1});
}

TEST_CASE(
    "mask samples: pictures of many colours are told from masks, those on one colour are masks of what has another") {
  Samples photo, on_black, colours;
  for (std::uint16_t i = 0; i < 256; ++i) {
    const std::uint16_t red = i, green = std::uint16_t(7 * i % 256), blue = std::uint16_t(19 * i % 256);
    photo.insert(photo.end(), {std::max<std::uint16_t>(red, 9), green, blue});
    on_black.insert(on_black.end(), {i < 128 ? std::uint16_t(0) : red, i < 128 ? std::uint16_t(0) : green, 0});
    colours.insert(colours.end(), {std::uint16_t(20 * (i / 32)), 90, 200});
  }
  CHECK(image_kind(row(photo, 3)) == ImageKind::kPhoto);
  CHECK(image_kind(row(on_black, 3)) == ImageKind::kPhotoOnOneColour);
  CHECK(image_kind(row(colours, 3)) == ImageKind::kMask);
  Bits object(128, 0);
  object.resize(256, 1);
  CHECK(object_pixels(row(on_black, 3)) == object);
  Samples on_green = on_black;
  for (std::size_t i = 0; i < 128; ++i) on_green[3 * i + 1] = std::uint16_t(250 + i % 6);
  CHECK(object_pixels(row(on_green, 3)) == object);
  CHECK(image_kind(row({0, 0, 0, 128, 0, 0}, 3)) == ImageKind::kMask);
  CHECK(image_kind(row({}, 3)) == ImageKind::kMask);
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

TEST_CASE("exactly one half is foreground in a given mask, background in a label, and set in a flag") {
  const float below = std::nextafter(0.5f, 0.f), above = std::nextafter(0.5f, 1.f);
  CHECK(mask_is_foreground(0.5f));
  CHECK_FALSE(mask_is_foreground(below));
  CHECK_FALSE(label_is_foreground(0.5f));
  CHECK(label_is_foreground(above));
  CHECK(is_set(0.5f));
  CHECK_FALSE(is_set(below));
}

TEST_CASE("NaN is background in masks and labels, and not set in flags") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(mask_is_foreground(nan));
  CHECK_FALSE(label_is_foreground(nan));
  CHECK_FALSE(is_set(nan));
}

TEST_CASE(
    "run-length encoded masks decode bit for bit: contours, signed zeros, NaN, planes of one value and empty ones") {
  ViewMasks masks{7, 3, {}, {1, 0, 1}, true};
  masks.target.push_back({0, 0, 1, 1, 0.25f, 0, 0, 1, 1, 1, 0.5f, 0.5f, 0.75f, 0, 0, 0, 0, 0, 0, 0, 1});
  masks.target.push_back({0.f, -0.f, 0.f, NAN, NAN, -NAN, std::nextafter(1.f, 0.f), 1.f});
  masks.target.emplace_back(21, 1.f);
  masks.target.emplace_back();
  const ViewMasks back = RleMasks(masks).unpacked();
  CHECK((back.width_px == 7 && back.height_px == 3 && back.available));
  CHECK(back.known == masks.known);
  REQUIRE(back.target.size() == masks.target.size());
  for (std::size_t k = 0; k < masks.target.size(); ++k) {
    REQUIRE(back.target[k].size() == masks.target[k].size());
    for (std::size_t i = 0; i < masks.target[k].size(); ++i)
      CHECK(std::bit_cast<std::uint32_t>(back.target[k][i]) == std::bit_cast<std::uint32_t>(masks.target[k][i]));
  }
  CHECK(RleMasks(masks).available());
  CHECK_FALSE(RleMasks().available());
  CHECK(RleMasks().unpacked().target.empty());
  ViewMasks used{2, 2, {{1, 1, 1, 1}}, {}, false};
  RleMasks(back).unpack(used);
  CHECK(used.width_px == 7);
  CHECK(used.target.size() == masks.target.size());
  CHECK(used.target[0] == masks.target[0]);
}

TEST_CASE("run-length encoded masks take memory in proportion to their contours, and never more than the planes") {
  ViewMasks binary{64, 64, {}, {}, true}, soft = binary;
  binary.target.emplace_back(64 * 64, 0.f);
  std::fill_n(binary.target[0].begin() + 1000, 2000, 1.f);
  soft.target.emplace_back(64 * 64);
  for (std::size_t i = 0; i < soft.target[0].size(); ++i) soft.target[0][i] = float(i % 255) / 255;
  soft.known.assign(64 * 64, 1);
  CHECK(RleMasks(binary).bytes() <= 3 * 8);
  CHECK(RleMasks(soft).bytes() == 64 * 64 * (sizeof(float) + 1));
  CHECK(RleMasks(soft).unpacked().target == soft.target);
}

}  // namespace ngs
