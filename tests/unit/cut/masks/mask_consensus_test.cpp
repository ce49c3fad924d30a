#include "ngs/cut/masks/mask_consensus.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/joint_case.h"

namespace ngs {
namespace {

/// A consensus drawn with characters: '#' object, '.' background, '?' unknown, '/' occluded object.
Consensus drawn(const std::vector<std::string>& rows) {
  Consensus c{int(rows[0].size()), int(rows.size()), {}, {}, {}};
  for (const std::string& row : rows)
    for (const char pixel : row) {
      c.object.push_back(pixel == '#');
      c.known.push_back(pixel != '?');
      c.alone.push_back(pixel == '#' || pixel == '/');
    }
  return c;
}

std::string row_of(const ViewPrompt& prompt, int y) {
  std::string row;
  for (int x = 0; x < prompt.width_px; ++x) row += "-+bo"[int(prompt.hint[std::size_t(y * prompt.width_px + x)])];
  return row;  // - background, + object, b and o likely
}

PixelMask mask_of(const std::vector<std::string>& rows) {
  PixelMask mask;
  for (const std::string& row : rows)
    for (const char pixel : row) mask.push_back(pixel == '#');
  return mask;
}

}  // namespace

TEST_CASE("pixels beyond the band are certain, unknown ones keep the side of the earlier mask") {
  const std::vector<std::string> rows(9, "......########????");
  CHECK(row_of(prompt_from(drawn(rows), 2, {}), 4) == "----bboo++++oobbbb");
  PixelMask before(9 * 18);
  for (std::size_t y = 0; y < 9; ++y) before[y * 18 + 14] = 1;
  CHECK(row_of(prompt_from(drawn(rows), 2, before), 4) == "----bboo++++ooobbb");
}

TEST_CASE("the middle of a thin part is certain if the consensus is clear") {
  Consensus c = drawn(std::vector<std::string>(40, std::string(20, '.') + "#######" + std::string(20, '.')));
  CHECK(row_of(prompt_from(c, 8, {}), 20).substr(8, 31) == "----bbbbbbbboo+++oobbbbbbbb----");
  for (float& share : c.object) share *= 0.7f;
  CHECK(row_of(prompt_from(c, 8, {}), 20).substr(8, 31) == "----bbbbbbbbooooooobbbbbbbb----");
}

TEST_CASE("pixels with something in front of the object are neither certain nor counted as agreement") {
  const Consensus c = drawn(std::vector<std::string>(7, ".......///////"));
  CHECK(row_of(prompt_from(c, 1, {}), 3) == "------bbbbbbbb");
  const Consensus half = drawn({"##//..", "##//.."});
  CHECK(agreement(half, mask_of({
                            "###...",
                            "##....",
                        })) == 1);
  CHECK(agreement(half, mask_of({
                            "##..#.",
                            "##....",
                        })) == doctest::Approx(0.8));
  CHECK(agreement(drawn({"..", ".."}), mask_of({"..", ".."})) == 1);
}

TEST_CASE("components without a certain pixel are removed, small unseeded holes are filled") {
  ViewPrompt prompt{12, 5, std::vector<PixelHint>(60, PixelHint::kLikelyBackground), false};
  prompt.hint[2 * 12 + 1] = PixelHint::kObject;
  prompt.hint[0] = PixelHint::kBackground;
  const PixelMask mask = mask_of({"............", ".#######..#.", ".#.##..#..#.", ".#######....", "............"});
  CHECK(keep_seeded_pieces(prompt, mask, 0.09) ==
        mask_of({"............", ".#######....", ".####..#....", ".#######....", "............"}));
  prompt.hint[2 * 12 + 2] = PixelHint::kBackground;
  CHECK(keep_seeded_pieces(prompt, mask, 0.09)[2 * 12 + 2] == 0);
  std::fill(prompt.hint.begin(), prompt.hint.end(), PixelHint::kLikelyObject);
  CHECK(keep_seeded_pieces(prompt, mask, 0) == mask);
}

TEST_CASE("prompt points lie deep inside each side and far from each other") {
  ViewPrompt prompt{40, 30, {}, false};
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      prompt.hint.push_back(x >= 8 && x < 32 && y >= 8 && y < 20 ? PixelHint::kObject : PixelHint::kBackground);
  const std::array<int, 4> box = object_box(prompt);
  CHECK(box == std::array<int, 4>{8, 8, 32, 20});
  const std::vector<PromptPoint> points = prompt_points(prompt, 3);
  REQUIRE(points.size() == 6);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inside = points[i].x >= 8 && points[i].x < 32 && points[i].y >= 8 && points[i].y < 20;
    CHECK(inside == points[i].object);
    CHECK(points[i].object == (i < 3));
    for (std::size_t k = 0; k < i; ++k)
      CHECK(std::max(std::abs(points[i].x - points[k].x), std::abs(points[i].y - points[k].y)) > 6);
  }
  std::fill(prompt.hint.begin(), prompt.hint.end(), PixelHint::kLikelyBackground);
  CHECK(prompt_points(prompt, 3).empty());
  CHECK(object_box(prompt) == std::array<int, 4>{});
}

TEST_CASE("a mask lifted to the Gaussians renders as itself in its own view, an empty one as empty") {
  const auto c = test::joint_case();
  const Camera& camera = c->scene.views[0].camera;
  PixelMask mask;
  for (const float target : c->masks[0].target[0]) mask.push_back(target > 0.5f);
  WeightSums<> one(c->truth.size(), 1), none = one;
  one.add(lift_mask({}, c->truth, camera, {}, mask));
  const ObjectPlace place = object_place(c->truth, one);
  CHECK(place.centre.z == doctest::Approx(3.6).epsilon(0.05));  // the near side of the ball at z = 4
  const Consensus seen = render_consensus({}, {c->truth, one, place}, camera, {});
  CHECK(agreement(seen, mask) > 0.85);
  CHECK(*std::min_element(seen.known.begin(), seen.known.end()) > 0.99f);
  const Consensus nothing = render_consensus({}, {c->truth, none, place}, camera, {});
  CHECK(*std::max_element(nothing.object.begin(), nothing.object.end()) == 0);
  CHECK(nothing.known[0] > 0.5f);  // the wall is beyond the ball's ObjectPlace::reach
  CHECK(object_place(c->truth, none).reach == 0);
}

TEST_CASE("Gaussians visible through the object are not lifted as part of it") {
  auto c = test::joint_case();
  const Camera& camera = c->scene.views[0].camera;
  PixelMask mask;
  for (const float target : c->masks[0].target[0]) mask.push_back(target > 0.5f);
  const ViewSums lifted = lift_mask({}, c->truth, camera, {}, mask);
  int through = 0, seen = 0;
  for (std::size_t v = 0; v < lifted.size(); ++v) {
    if (lifted.row[v] < 160) continue;  // else the wall
    through += lifted.object_weight(v, 0) > 0.5 * lifted.weight(v);
    seen += lifted.weight(v) > 0;
  }
  CHECK(seen > 60);
  CHECK(through <= seen / 10);
}

}  // namespace ngs
