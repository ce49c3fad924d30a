#include "ngs/ops/image/grab_cut.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace ngs {
namespace {

constexpr int kWidth = 64, kHeight = 48;

bool in_disc(int x, int y) { return std::hypot(x - 30, y - 22) < 12; }

/// A noisy yellow disc on noisy blue.
ImageU8 disc_photo() {
  ImageU8 photo(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) {
        const bool bright = in_disc(x, y) == (c < 2);
        photo.at(x, y, c) = std::uint8_t((bright ? 180 : 40) + (x * 7 + y * 13 + c * 5) % 23);
      }
  return photo;
}

ViewPrompt prompt_of(const auto& hint) {
  ViewPrompt p{kWidth, kHeight, {}, true};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) p.hint.push_back(hint(x, y));
  return p;
}

}  // namespace

TEST_CASE("grab_cut finds the whole object from one stroke per side, with the same bytes every time") {
  const ViewPrompt strokes = prompt_of([](int x, int y) {
    return y == 22 && x > 25 && x < 35 ? PixelHint::kObject
           : y == 4                    ? PixelHint::kBackground
                                       : PixelHint::kLikelyBackground;
  });
  const PixelMask mask = grab_cut(disc_photo(), strokes, {});
  int wrong = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) wrong += (mask[std::size_t(y * kWidth + x)] != 0) != in_disc(x, y);
  CHECK(wrong == 0);
  CHECK(grab_cut(disc_photo(), strokes, {}) == mask);
}

TEST_CASE("grab_cut keeps the side of certain pixels against their colours") {
  const ViewPrompt against = prompt_of([](int x, int y) {
    if (x == 30 && y == 22) return PixelHint::kBackground;
    if (x == 5 && y == 5) return PixelHint::kObject;
    return in_disc(x, y) ? PixelHint::kLikelyObject : PixelHint::kLikelyBackground;
  });
  const PixelMask mask = grab_cut(disc_photo(), against, {});
  CHECK(mask[22 * kWidth + 30] == 0);
  CHECK(mask[5 * kWidth + 5] == 1);
}

TEST_CASE("grab_cut returns the hints if one side has too few pixels or none can change") {
  const ImageU8 photo = disc_photo();
  for (const PixelHint all :
       {PixelHint::kBackground, PixelHint::kObject, PixelHint::kLikelyBackground, PixelHint::kLikelyObject}) {
    const PixelMask mask = grab_cut(photo, prompt_of([&](int, int) { return all; }), {});
    CHECK(mask == PixelMask(std::size_t(kWidth * kHeight), is_object(all)));
  }
  // Four pixels: one fewer than the mixture has components.
  const auto four_pixels = [](int x, int y) {
    return y == 0 && x < 4 ? PixelHint::kObject : PixelHint::kLikelyBackground;
  };
  const PixelMask four = grab_cut(photo, prompt_of(four_pixels), {});
  CHECK(std::count(four.begin(), four.end(), 1) == 4);
}

}  // namespace ngs
