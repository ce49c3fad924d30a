#include "ngs/edit/select/touched_pieces.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/splat_shapes.h"

namespace ngs {
namespace {

/// Lattices of 6 x 6 x 6 solid Gaussians, 0.1 apart, with a corner at each of these x.
GaussianCloud blocks_at(const std::vector<double>& corners) {
  GaussianCloud cloud;
  for (const double x : corners)
    for (int k = 0; k < 216; ++k)
      test::add_gaussian(cloud, {x + 0.1 * (k % 6), 0.1 * (k / 6 % 6), 0.1 * (k / 36)}, 0.04);
  classify(cloud);
  return cloud;
}

void add_rows(std::uint32_t first, std::size_t count, double weight, ViewSums& stroke) {
  for (std::uint32_t i = first; i < first + count; ++i) stroke.add(i, &weight);
}

/// Weight 1 on each of the first `count` Gaussians from `first` on.
ViewSums on_rows(std::uint32_t first, std::size_t count) {
  ViewSums stroke{0, false, {}, {}};
  add_rows(first, count, 1, stroke);
  return stroke;
}

std::int64_t in_block(const PieceSelection& pieces, std::size_t block) {
  const auto begin = pieces.object.begin() + std::ptrdiff_t(216 * block);
  return std::count(begin, begin + 216, std::uint8_t(1));
}

}  // namespace

TEST_CASE("a stroke keeps the piece that it touches and leaves the others out") {
  const GaussianCloud cloud = blocks_at({0, 3, 6});
  const std::vector<ViewSums> strokes{on_rows(216, 20)};
  const PieceSelection pieces = touched_pieces({}, cloud, std::vector<std::uint8_t>(648, 1), strokes);
  CHECK(pieces.pieces == 3);
  CHECK(pieces.kept_pieces == 1);
  CHECK(pieces.removed == 432);
  CHECK(in_block(pieces, 0) == 0);
  CHECK(in_block(pieces, 1) == 216);
  CHECK(in_block(pieces, 2) == 0);
}

TEST_CASE("strokes on several pieces, and one across several, keep all of them") {
  const GaussianCloud cloud = blocks_at({0, 3, 6, 9});
  ViewSums across = on_rows(0, 20);
  add_rows(216, 6, 1, across);
  const PieceSelection pieces =
      touched_pieces({}, cloud, std::vector<std::uint8_t>(864, 1), std::vector{across, on_rows(432, 2)});
  CHECK(pieces.kept_pieces == 3);
  CHECK(in_block(pieces, 3) == 0);
}

TEST_CASE("a piece that no stroke touches is kept if enough masks show it, and if a stroke touches another") {
  const GaussianCloud cloud = blocks_at({0, 3, 6});
  const std::vector<std::uint8_t> all(648, 1);
  ViewSums mask = on_rows(0, 200);
  add_rows(216, 3, 1, mask);  // more than a hundredth of the mask
  add_rows(432, 1, 1, mask);  // less
  const std::vector<ViewSums> strokes{on_rows(0, 20)};
  const PieceSelection shown = touched_pieces({}, cloud, all, strokes, std::vector(kMinMasks, mask));
  CHECK(in_block(shown, 0) == 216);
  CHECK(in_block(shown, 1) == 216);
  CHECK(in_block(shown, 2) == 0);
  const PieceSelection rarely = touched_pieces({}, cloud, all, strokes, std::vector(kMinMasks - 1, mask));
  CHECK(in_block(rarely, 1) == 0);
  CHECK(touched_pieces({}, cloud, all, {}, std::vector(kMinMasks, mask)).removed == 0);
}

TEST_CASE("Gaussians visible through the object under a stroke are not touched") {
  const GaussianCloud cloud = blocks_at({0, 3});
  ViewSums stroke = on_rows(0, 20);
  add_rows(216, 20, 0.05, stroke);
  const PieceSelection pieces = touched_pieces({}, cloud, std::vector<std::uint8_t>(432, 1), std::vector{stroke});
  CHECK(in_block(pieces, 0) == 216);
  CHECK(in_block(pieces, 1) == 0);
}

TEST_CASE("a large Gaussian that reaches a touched piece is kept, a small one at its place is left out") {
  for (const double scale : {0.4, 0.04}) {
    GaussianCloud cloud = blocks_at({0, 3});
    const auto i = std::size_t(cloud.size());
    test::add_gaussian(cloud, {1.2, 0.2, 0.2}, scale);
    classify(cloud);
    const PieceSelection pieces =
        touched_pieces({}, cloud, std::vector<std::uint8_t>(i + 1, 1), std::vector{on_rows(0, 20)});
    CHECK(pieces.object[i] == (scale > 0.1));
    CHECK(in_block(pieces, 0) == 216);
    CHECK(in_block(pieces, 1) == 0);
    CHECK(pieces.removed == (scale > 0.1f ? 216 : 217));
  }
}

TEST_CASE("without a stroke on the selection all pieces are kept") {
  const GaussianCloud cloud = blocks_at({0, 3});
  std::vector<std::uint8_t> member(432, 1);
  std::fill(member.begin(), member.begin() + 216, std::uint8_t(0));
  for (const std::vector<ViewSums>& strokes : {std::vector<ViewSums>{}, {on_rows(0, 20)}}) {
    const PieceSelection pieces = touched_pieces({}, cloud, member, strokes);
    CHECK(pieces.object == member);
    CHECK(pieces.removed == 0);
  }
  CHECK(touched_pieces({}, cloud, std::vector<std::uint8_t>(432), std::vector{on_rows(0, 2)}).pieces == 0);
}

TEST_CASE("disconnected strokes are separate masks, the smallest share the last mask") {
  ViewPrompt marks{100, 40, std::vector<PixelHint>(4000, PixelHint::kLikelyBackground), true};
  for (int k = 0; k < 20; ++k)
    for (int x = 0; x < 20 - k; ++x) marks.hint[std::size_t(2 * k * 100 + x)] = PixelHint::kObject;
  const std::vector<PixelMask> strokes = object_strokes(marks);
  REQUIRE(strokes.size() == kMaxStrokes);
  CHECK(std::count(strokes[0].begin(), strokes[0].end(), 1) == 20);
  CHECK(std::count(strokes[15].begin(), strokes[15].end(), 1) == 5 + 4 + 3 + 2 + 1);
  CHECK(object_strokes({4, 4, std::vector<PixelHint>(16, PixelHint::kBackground), true}).empty());
}

}  // namespace ngs
