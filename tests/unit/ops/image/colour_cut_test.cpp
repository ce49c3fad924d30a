#include "ngs/ops/image/colour_cut.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/ops/image/grab_cut.h"
#include "support/random.h"

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

/// colour_cut of a browser, from colour_cut_web.cpp (tests/CMakeLists.txt).
void colour_cut_web(HintedRegion& region, const SideColours& known, int iterations, std::uint64_t seed);

namespace {

/// Patches in few colours, with noise from none (every cut has rivals of the same capacity) to much.
HintedRegion random_region(test::Random& random) {
  HintedRegion region{10 + int(random.below(60)), 1 + int(random.below(50)), {}, {}};
  const int patch = 1 + int(random.below(12)), colours = 2 + int(random.below(6)), noise = 1 + int(random.below(60));
  const std::int64_t rare = 2 + random.below(60);
  std::vector<int> colour(std::size_t(3 * colours));
  for (int& c : colour) c = int(random.below(256));
  for (int y = 0; y < region.height_px; ++y)
    for (int x = 0; x < region.width_px; ++x) {
      const int k = (x / patch * 7 + y / patch * 5 + x / patch * (y / patch)) % colours;
      std::array<std::uint8_t, 3> pixel;
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = std::uint8_t(std::clamp(colour[std::size_t(3 * k) + c] + int(random.below(noise)), 0, 255));
      region.colour.push_back(pixel);
      region.hint.push_back(random.below(rare) == 0 ? PixelHint(random.below(2)) : PixelHint(2 + random.below(2)));
    }
  for (std::size_t p = 0; p < 10; ++p) region.hint[p] = p % 2 == 0 ? PixelHint::kObject : PixelHint::kBackground;
  return region;
}

SideColours certain_colours(const HintedRegion& region) {
  SideColours known;
  for (std::size_t p = 0; p < region.hint.size(); ++p)
    if (is_certain(region.hint[p]))
      (is_object(region.hint[p]) ? known.object : known.background).push_back(region.colour[p]);
  return known;
}

}  // namespace

TEST_CASE("the cuts of a browser give the labels of OpenCV, also where several cuts have the same capacity") {
  test::Random random(7);
  int changed = 0;
  for (int round = 0; round < 200; ++round) {
    CAPTURE(round);
    const HintedRegion region = random_region(random);
    const SideColours known = certain_colours(region);
    const int iterations = 1 + int(random.below(4));
    const std::uint64_t seed = std::uint64_t(random.below(1000));
    HintedRegion by_opencv = region, by_browser = region;
    colour_cut(by_opencv, known, iterations, seed);
    colour_cut_web(by_browser, known, iterations, seed);
    CHECK(by_browser.hint == by_opencv.hint);
    for (std::size_t p = 0; p < region.hint.size(); ++p) changed += by_opencv.hint[p] != region.hint[p];
  }
  CHECK(changed > 10'000);
}

}  // namespace ngs
