#include <doctest/doctest.h>

#include <cmath>

#include "ngs/edit/finish/alone.h"

namespace ngs::finish {
namespace {

constexpr int kSide_px = 96;

/// A disc, brighter than its checkered surroundings by `contrast`.
ImageF disc_photo(double radius, float contrast) {
  ImageF photo(kSide_px, kSide_px, 3);
  for (int y = 0; y < kSide_px; ++y)
    for (int x = 0; x < kSide_px; ++x)
      for (int c = 0; c < 3; ++c)
        photo.at(x, y, c) = std::hypot(x - 48, y - 48) < radius ? 0.5f + contrast : 0.45f + 0.1f * float((x / 5) % 2);
  return photo;
}

std::vector<GivenMask> disc_mask(double radius, int shift = 0) {
  std::vector<GivenMask> mask;
  for (int y = 0; y < kSide_px; ++y)
    for (int x = 0; x < kSide_px; ++x)
      mask.push_back(std::hypot(x - 48 - shift, y - 48) < radius ? GivenMask::kObject : GivenMask::kBackground);
  return mask;
}

int lack_of(const std::vector<std::vector<GivenMask>>& masks, const ImageF& photo) {
  MaskLack lack;
  for (const auto& mask : masks) lack.add(mask, photo);
  return lack.px();
}

TEST_CASE("masks that are too small by 3 and 5 px lack about so much; exact, larger and displaced masks lack nothing") {
  const ImageF photo = disc_photo(30, 0.4f);
  CHECK(lack_of({disc_mask(27), disc_mask(27)}, photo) == 3);
  CHECK(lack_of({disc_mask(25)}, photo) >= 4);  // chessboard distances: 5 along the axes, 3.5 along diagonals
  CHECK(lack_of({disc_mask(30)}, photo) == 0);
  CHECK(lack_of({disc_mask(33)}, photo) == 0);
  CHECK(lack_of({disc_mask(30, 3), disc_mask(30, -3)}, photo) == 0);
}

TEST_CASE("exact masks of a plain object before a texture with more contrast than its contour lack nothing") {
  ImageF photo = disc_photo(30, 0.1f);
  for (int y = 0; y < kSide_px; ++y)
    for (int x = 0; x < kSide_px; ++x)
      for (int c = 0; c < 3 && std::hypot(x - 48, y - 48) >= 30; ++c)
        photo.at(x, y, c) = (x / 2 + y / 2) % 2 ? 1.0f : 0.1f;
  CHECK(lack_of({disc_mask(30)}, photo) == 0);
}

TEST_CASE("one mask that is too small among exact ones, unknown and empty masks, and no photo: nothing is lacking") {
  const ImageF photo = disc_photo(30, 0.4f);
  CHECK(lack_of({disc_mask(30), disc_mask(27), disc_mask(30)}, photo) == 0);
  CHECK(lack_of({std::vector(kSide_px * kSide_px, GivenMask::kUnknown)}, photo) == 0);
  CHECK(lack_of({std::vector(kSide_px * kSide_px, GivenMask::kBackground)}, photo) == 0);
  CHECK(MaskLack().px() == 0);
}

}  // namespace
}  // namespace ngs::finish
