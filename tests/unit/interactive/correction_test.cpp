#include "ngs/interactive/correction.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/interactive/live_mask.h"

namespace ngs {
namespace {

constexpr int kWidth = 240, kHeight = 180, kReach_px = 75;

/// A pale statue on a dark plinth, on a brown floor in front of a dark blue wall, all with grain.
enum class Kind { kStatue, kPlinth, kFloor, kWall };
Kind kind_at(int x, int y) {
  if (std::abs(x - 60) < 18 && y > 40 && y < 100) return Kind::kStatue;
  if (std::abs(x - 60) < 24 && y >= 100 && y < 150) return Kind::kPlinth;
  return y >= 110 ? Kind::kFloor : Kind::kWall;
}

ImageU8 picture() {
  constexpr int kColour[4][3] = {{210, 190, 160}, {62, 50, 60}, {130, 105, 80}, {50, 75, 125}};
  ImageU8 image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = std::uint8_t(kColour[int(kind_at(x, y))][c] + (x * 7 + y * 13 + c * 5) % 23);
  return image;
}

struct Strokes {
  ViewPrompt all{kWidth, kHeight, std::vector<PixelHint>(kWidth* kHeight, PixelHint::kLikelyBackground), true};
  ViewPrompt added = all;

  /// A horizontal line.
  void draw(int x0, int x1, int y, PixelHint side) {
    std::fill(added.hint.begin(), added.hint.end(), PixelHint::kLikelyBackground);
    for (int v = y - 2; v <= y + 2; ++v)
      for (int x = x0; x < x1; ++x)
        all.hint[std::size_t(v * kWidth + x)] = added.hint[std::size_t(v * kWidth + x)] = side;
  }
};

PixelMask mask_of(std::initializer_list<Kind> kinds) {
  PixelMask mask;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) mask.push_back(std::ranges::count(kinds, kind_at(x, y)) > 0);
  return mask;
}

std::int64_t differing(const PixelMask& a, const PixelMask& b) {
  std::int64_t count = 0;
  for (std::size_t p = 0; p < a.size(); ++p) count += a[p] != b[p];
  return count;
}

}  // namespace

TEST_CASE("a stroke on the plinth adds the plinth but not the unmarked wall") {
  const ImageU8 image = picture();
  const PixelMask statue = mask_of({Kind::kStatue}), both = mask_of({Kind::kStatue, Kind::kPlinth});
  Strokes strokes;
  strokes.draw(45, 75, 70, PixelHint::kObject);
  strokes.draw(100, 230, 165, PixelHint::kBackground);
  strokes.draw(45, 75, 125, PixelHint::kObject);
  const live::Correction correction{statue, strokes.all, strokes.added};
  const PixelMask found = live::live_mask(image, correction.prompt(kReach_px, 0), correction.colours(image, 512), 0);
  CHECK(differing(live::corrected(statue, found, strokes.added), both) < 700);
  // With the colours of the strokes only, and an unlimited reach, the wall is added too.
  const PixelMask naive = live::corrected(statue, live::live_mask(image, strokes.all, 0), strokes.added);
  CHECK(differing(naive, both) > 10'000);
}

TEST_CASE("a background stroke on the plinth removes the plinth only") {
  const ImageU8 image = picture();
  const PixelMask statue = mask_of({Kind::kStatue}), both = mask_of({Kind::kStatue, Kind::kPlinth});
  Strokes strokes;
  strokes.draw(45, 75, 70, PixelHint::kObject);
  strokes.draw(45, 75, 125, PixelHint::kBackground);
  const live::Correction correction{both, strokes.all, strokes.added};
  const PixelMask found = live::live_mask(image, correction.prompt(kReach_px, 0), correction.colours(image, 512), 0);
  CHECK(differing(live::corrected(both, found, strokes.added), statue) < 400);
}

TEST_CASE("a correction keeps the mask beyond the reach of new strokes, and keeps all strokes") {
  Strokes strokes;
  strokes.draw(20, 30, 20, PixelHint::kBackground);
  strokes.draw(100, 140, 90, PixelHint::kObject);
  const PixelMask before = mask_of({Kind::kFloor});
  const ViewPrompt prompt = live::Correction{before, strokes.all, strokes.added}.prompt(20, 0);
  const auto at = [&](int x, int y) { return prompt.hint[std::size_t(y * kWidth + x)]; };
  CHECK(at(25, 20) == PixelHint::kBackground);
  CHECK(at(120, 90) == PixelHint::kObject);
  CHECK(at(120, 75) == PixelHint::kLikelyBackground);
  CHECK(at(120, 111) == PixelHint::kLikelyObject);
  CHECK(at(120, 60) == PixelHint::kBackground);
  CHECK(at(120, 130) == PixelHint::kObject);
  // The earlier stroke is not a new one.
  CHECK(at(25, 30) == PixelHint::kBackground);
}

TEST_CASE("correction colours: strokes have the same weight as all other pixels of their side") {
  const ImageU8 image = picture();
  Strokes strokes;
  strokes.draw(45, 75, 70, PixelHint::kObject);
  strokes.draw(45, 75, 125, PixelHint::kBackground);
  const PixelMask before = mask_of({Kind::kStatue, Kind::kPlinth});
  const SideColours colours = live::Correction{before, strokes.all, strokes.added}.colours(image, 64);
  CHECK(colours.object.size() == 128);
  REQUIRE(colours.background.size() == 128);
  const auto dark = [](const auto& colour) { return colour[0] < 90 && colour[2] < 90; };
  CHECK(std::ranges::count_if(colours.background, dark) == 64);
  const PixelMask all(before.size(), 1);
  CHECK(live::Correction{all, strokes.all, strokes.added}.colours(image, 64).background.size() == 64);
}

}  // namespace ngs
