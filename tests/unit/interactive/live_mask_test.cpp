#include "ngs/interactive/live_mask.h"

#include <doctest/doctest.h>

#include <cmath>

namespace ngs {
namespace {

constexpr int kWidth_px = 400, kHeight_px = 300;

/// A green disc on a brown background, both with grain.
struct DiscPicture {
  double x = 180, y = 140, radius = 70;
  ImageU8 picture{kWidth_px, kHeight_px, 3};
  ViewPrompt prompt{kWidth_px, kHeight_px,
                    std::vector<PixelHint>(std::size_t(kWidth_px* kHeight_px), PixelHint::kLikelyBackground), true};

  DiscPicture() {
    for (int v = 0; v < kHeight_px; ++v)
      for (int u = 0; u < kWidth_px; ++u) {
        const int grain = (u * 7 + v * 13) % 17;
        const bool in = inside(u, v);
        picture.at(u, v, 0) = std::uint8_t((in ? 40 : 120) + grain);
        picture.at(u, v, 1) = std::uint8_t((in ? 150 : 90) + grain);
        picture.at(u, v, 2) = std::uint8_t(60 + grain);
      }
  }
  bool inside(int u, int v) const { return std::hypot(u + 0.5 - x, v + 0.5 - y) < radius; }
  void dab(int u0, int v0, PixelHint hint) {
    for (int v = v0 - 4; v <= v0 + 4; ++v)
      for (int u = u0 - 4; u <= u0 + 4; ++u) prompt.hint[std::size_t(v * kWidth_px + u)] = hint;
  }
};

}  // namespace

TEST_CASE("one dab on each side finds the disc within two pixels") {
  DiscPicture disc;
  disc.dab(180, 140, PixelHint::kObject);
  disc.dab(40, 40, PixelHint::kBackground);
  const PixelMask mask = live::live_mask(disc.picture, disc.prompt, 0);
  int wrong = 0;
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) wrong += (mask[std::size_t(v * kWidth_px + u)] != 0) != disc.inside(u, v);
  CHECK(wrong < 2 * 3.15 * 70);  // a band of a pixel on both sides of the contour
}

TEST_CASE("strokes override colours, and without an object stroke the mask is empty") {
  DiscPicture disc;
  CHECK(live::live_mask(disc.picture, disc.prompt, 0) == PixelMask(disc.prompt.hint.size()));
  disc.dab(180, 140, PixelHint::kObject);
  disc.dab(40, 40, PixelHint::kBackground);
  disc.dab(200, 160, PixelHint::kBackground);
  const PixelMask mask = live::live_mask(disc.picture, disc.prompt, 0);
  for (int v = 156; v <= 164; ++v)
    for (int u = 196; u <= 204; ++u) CHECK(mask[std::size_t(v * kWidth_px + u)] == 0);
  CHECK(mask[std::size_t(140 * kWidth_px + 180)] == 1);
  const ImageU8 pixel(1, 1, 3);
  CHECK(live::live_mask(pixel, {1, 1, {PixelHint::kObject}, true}, 0) == PixelMask{1});
}

TEST_CASE("a background stroke around the object makes everything outside background") {
  constexpr int kSide = 40;
  const auto prompt_with = [](int gap) {
    ViewPrompt prompt{kSide, kSide, std::vector<PixelHint>(kSide * kSide, PixelHint::kLikelyBackground), true};
    for (int k = 10; k <= 30; ++k)
      for (const int p : {10 * kSide + k, 30 * kSide + k, k * kSide + 10, k * kSide + 30})
        prompt.hint[std::size_t(p)] = PixelHint::kBackground;
    prompt.hint[20 * kSide + 20] = PixelHint::kObject;
    if (gap > 0) prompt.hint[10 * kSide + 20] = PixelHint::kLikelyBackground;
    return prompt;
  };
  ViewPrompt closed = prompt_with(0);
  CHECK(live::fill_surrounded(closed));
  CHECK(closed.hint[15 * kSide + 15] == PixelHint::kLikelyObject);
  CHECK(closed.hint[5 * kSide + 5] == PixelHint::kBackground);
  CHECK(closed.hint[20 * kSide + 20] == PixelHint::kObject);

  ViewPrompt open = prompt_with(1);
  const std::vector<PixelHint> before = open.hint;
  CHECK_FALSE(live::fill_surrounded(open));
  CHECK(open.hint == before);

  ViewPrompt outside = prompt_with(0);  // the object is also marked outside the line
  outside.hint[5 * kSide + 5] = PixelHint::kObject;
  CHECK_FALSE(live::fill_surrounded(outside));
}

}  // namespace ngs
