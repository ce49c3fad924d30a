#include "ngs/cut/masks/rasterise_prompt.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/core/error.h"
#include "support/error_code.h"

namespace ngs {
namespace {

HandPrompt of_size(int width, int height) {
  HandPrompt p;
  p.width_px = width;
  p.height_px = height;
  return p;
}

PixelHint at(const ViewPrompt& p, int x, int y) { return p.hint[std::size_t(y * p.width_px + x)]; }

}  // namespace

TEST_CASE("strokes have their radius at any image size, and later ones override earlier ones") {
  HandPrompt hand = of_size(200, 100);
  hand.strokes = {{true, 10, {{30, 50}, {150, 50}}}, {false, 3, {{100, 50}}}};
  const double pi = 3.14159265358979, area = 120 * 20 + pi * 100 - pi * 9;
  for (const int factor : {1, 2}) {
    CAPTURE(factor);
    const ViewPrompt p = rasterise(hand, 200 * factor, 100 * factor);
    CHECK(p.by_hand);
    CHECK(double(std::count(p.hint.begin(), p.hint.end(), PixelHint::kObject)) ==
          doctest::Approx(area * factor * factor).epsilon(0.02));
    CHECK(at(p, 100 * factor, 50 * factor) == PixelHint::kBackground);
    CHECK(at(p, 60 * factor, 41 * factor) == PixelHint::kObject);
    CHECK(at(p, 60 * factor, 38 * factor) == PixelHint::kLikelyBackground);
  }
}

TEST_CASE("outside all boxes is background, inside is likely object, and strokes override both") {
  HandPrompt hand = of_size(20, 10);
  hand.boxes = {{2, 2, 8, 8}, {10, 2, 18, 8}};
  hand.strokes = {{true, 1, {{9, 5}}}};
  const ViewPrompt p = rasterise(hand, 20, 10);
  CHECK(at(p, 2, 2) == PixelHint::kLikelyObject);
  CHECK(at(p, 17, 7) == PixelHint::kLikelyObject);
  CHECK(at(p, 18, 7) == PixelHint::kBackground);
  CHECK(at(p, 9, 2) == PixelHint::kBackground);
  CHECK(at(p, 9, 5) == PixelHint::kObject);
}

TEST_CASE("polygons are filled by the even-odd rule, below strokes and above painted pixels") {
  HandPrompt hand = of_size(20, 10);
  hand.painted.assign(200, PixelHint::kBackground);
  hand.polygons = {{true, {{2, 2}, {18, 2}, {18, 8}, {2, 8}, {2, 2}, {6, 4}, {6, 6}, {10, 6}, {10, 4}, {6, 4}}}};
  hand.strokes = {{false, 0.75, {{15.5, 5.5}}}};
  for (const int factor : {1, 3}) {
    const ViewPrompt p = rasterise(hand, 20 * factor, 10 * factor);
    CHECK(std::count(p.hint.begin(), p.hint.end(), PixelHint::kBackground) > 0);
    CHECK(at(p, 2 * factor, 2 * factor) == PixelHint::kObject);
    CHECK(at(p, 18 * factor - 1, 8 * factor - 1) == PixelHint::kObject);
    CHECK(at(p, 18 * factor, 5 * factor) == PixelHint::kBackground);
    CHECK(at(p, 7 * factor, 5 * factor) == PixelHint::kBackground);  // the hole
    CHECK(at(p, 15 * factor + factor / 2, 5 * factor + factor / 2) == PixelHint::kBackground);
  }
}

TEST_CASE("marks of several files on one view are combined") {
  std::vector<HandPrompt> marks = {of_size(20, 10), of_size(40, 20), of_size(20, 10)};
  marks[0].strokes = {{true, 1, {{5, 5}}}, {true, 1, {{12, 5}}}};
  marks[1].strokes = {{false, 2, {{24, 10}}}};  // at the position of the second stroke of the first file
  marks[2].boxes = {{2, 2, 18, 8}};
  const ViewPrompt p = rasterise(marks, 20, 10);
  CHECK(at(p, 5, 5) == PixelHint::kObject);
  CHECK(at(p, 12, 5) == PixelHint::kBackground);
  CHECK(at(p, 8, 3) == PixelHint::kLikelyObject);
  CHECK(at(p, 0, 0) == PixelHint::kBackground);
}

TEST_CASE("painted pixels are scaled and strokes beyond the image are clipped") {
  HandPrompt hand = of_size(4, 2);
  hand.painted.assign(8, PixelHint::kLikelyBackground);
  hand.painted[1] = PixelHint::kObject;
  hand.strokes = {{false, 1e5, {{-1e6, 1}}}, {false, 0.6, {{1e7, 1e7}, {3, 1}}}};
  const ViewPrompt p = rasterise(hand, 8, 4);
  CHECK(at(p, 2, 0) == PixelHint::kObject);
  CHECK(at(p, 3, 1) == PixelHint::kObject);
  CHECK(at(p, 6, 2) == PixelHint::kBackground);
  CHECK(at(p, 0, 3) == PixelHint::kLikelyBackground);
}

TEST_CASE("prompts with another aspect ratio than the view are kInconsistent") {
  CHECK(test::code_of([&] { rasterise(of_size(20, 10), 20, 12); }) == ErrorCode::kInconsistent);
}

}  // namespace ngs
