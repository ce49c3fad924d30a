#include "ngs/cut/masks/mask_spread.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/error_code.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// The joint case with a segmenter that returns the true masks, except where a test changes one.
struct SpreadCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  std::vector<PixelMask> answer;
  std::vector<bool> has_photo;
  std::vector<std::vector<ViewPrompt>> asked;
  std::vector<SpreadView> result;
  std::map<std::size_t, ViewPrompt> marked;

  SpreadCase() : has_photo(4, true), asked(4), result(4) {
    for (const ViewMasks& m : base->masks) {
      answer.emplace_back();
      for (const float target : m.target[0]) answer.back().push_back(target > 0.5f);
    }
  }
  void mark(std::size_t view, PixelHint hint) {
    ViewPrompt hand{48, 40, std::vector<PixelHint>(48 * 40, PixelHint::kLikelyBackground), true};
    hand.hint[20 * 48 + 24] = hint;
    marked[view] = hand;
  }
  std::vector<SpreadView> spread(const SpreadOptions& options, int threads = 1) {
    std::vector<Camera> cameras;
    for (const SceneView& view : base->scene.views) cameras.push_back(view.camera);
    if (marked.empty()) mark(0, PixelHint::kObject);
    const SpreadInput input{base->truth,
                            base->scene,
                            cameras,
                            has_photo,
                            {},
                            marked,
                            [&](std::size_t view, const ViewPrompt& prompt) {
                              asked[view].push_back(prompt);
                              return answer[view];
                            },
                            [&](std::size_t view, const SpreadView& r) { result[view] = r; }};
    spread_masks({.threads = threads}, test::Quiet(), options, input);
    return result;
  }
  double iou(std::size_t view, const PixelMask& mask) const {
    double both = 0, either = 0;
    for (std::size_t p = 0; p < mask.size(); ++p) {
      const bool a = base->masks[view].target[0][p] > 0.5f, b = mask[p] != 0;
      both += a && b;
      either += a || b;
    }
    return both / either;
  }
};

Camera camera_at(double x, double y, double z) {
  return {.name = {}, .rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}}, .translation = {-x, -y, -z}};
}

}  // namespace

TEST_CASE("every view is segmented once per pass, after the first with certain pixels of both sides") {
  SpreadCase c;
  const auto result = c.spread({.passes = 2});
  CHECK(c.asked[0].size() == 2);
  CHECK(c.asked[0][0].by_hand);
  for (std::size_t v = 1; v < 4; ++v) {
    CAPTURE(v);
    REQUIRE(c.asked[v].size() == 2);
    for (const PixelHint side : {PixelHint::kObject, PixelHint::kBackground})
      CHECK(std::count(c.asked[v][1].hint.begin(), c.asked[v][1].hint.end(), side) > 50);
    CHECK(result[v].source == MaskSource::kSegmented);
    CHECK(result[v].mask == c.answer[v]);
    CHECK(result[v].agreement > 0.8);
  }
  CHECK(result[0].source == MaskSource::kReference);
  CHECK(c.asked[0][1].hint[20 * 48 + 24] == PixelHint::kObject);
}

TEST_CASE("a mask that contradicts the others is rejected and replaced by their render") {
  SpreadCase c;
  std::fill(c.answer[2].begin(), c.answer[2].begin() + 48 * 20, std::uint8_t(1));
  std::fill(c.answer[2].begin() + 48 * 20, c.answer[2].end(), std::uint8_t(0));
  const auto result = c.spread({.passes = 2});
  CHECK(result[2].source == MaskSource::kRendered);
  CHECK(result[2].agreement < 0.7);
  CHECK(c.iou(2, result[2].mask) > 0.8);
  for (const std::size_t v : {1u, 3u}) CHECK(result[v].source == MaskSource::kSegmented);
}

TEST_CASE("a view without a photo gets the rendered consensus as its mask") {
  SpreadCase c;
  c.has_photo[3] = false;
  const auto result = c.spread({.passes = 1});
  CHECK(c.asked[3].empty());
  CHECK(result[3].source == MaskSource::kRendered);
  CHECK(result[3].agreement < 0);
  CHECK(c.iou(3, result[3].mask) > 0.8);
}

TEST_CASE("the photo of a held-out view changes the mask of that view only") {
  SpreadCase right, wider;
  for (SpreadCase* c : {&right, &wider}) c->base->scene.views[2].split = Split::kHeldOut;
  for (std::size_t p = 0; p + 1 < wider.answer[2].size(); ++p)  // one pixel more to the left: agrees well enough
    if (right.answer[2][p + 1]) wider.answer[2][p] = 1;
  const auto a = right.spread({.passes = 2}), b = wider.spread({.passes = 2});
  CHECK(a[2].source == MaskSource::kSegmented);
  CHECK(b[2].mask == wider.answer[2]);
  CHECK(right.asked[2].size() == 1);  // in the last pass
  for (const std::size_t v : {0u, 1u, 3u}) {
    CAPTURE(v);
    CHECK(a[v].soft == b[v].soft);
  }
}

TEST_CASE("the masks do not depend on the number of threads") {
  SpreadCase one, three;
  one.has_photo[1] = three.has_photo[1] = false;
  const auto a = one.spread({.passes = 2}, 1), b = three.spread({.passes = 2}, 3);
  for (std::size_t v = 0; v < 4; ++v) CHECK((a[v].mask == b[v].mask && a[v].soft == b[v].soft));
}

TEST_CASE("empty pixels of the model are background in all masks, whatever the segmenter returns") {
  SpreadCase c;
  GaussianCloud& cloud = c.base->truth;
  for (std::int64_t i = 0; i < cloud.size(); ++i)  // removes the left half of the first view's Gaussians
    if (cloud.position[3 * std::size_t(i)] < 0) cloud.logit_opacity[std::size_t(i)] = -12;
  for (PixelMask& mask : c.answer) std::fill(mask.begin(), mask.end(), std::uint8_t(1));
  const auto result = c.spread({.gate_iou = 0, .passes = 2});
  std::int64_t empty = 0;
  for (std::size_t v = 0; v < 4; ++v) {
    RenderRequest request{.colour = false, .label = {}};
    const RenderedView view = render({}, cloud, c.base->scene.views[v].camera, {}, request);
    for (std::size_t p = 0; p < result[v].mask.size(); ++p)
      if (view.alpha.data[p] < kEmptyAlpha && c.marked.at(0).hint[p] != PixelHint::kObject) {
        ++empty;
        CHECK(result[v].mask[p] == 0);
        CHECK(c.asked[v].back().hint[p] == PixelHint::kBackground);
      }
  }
  CHECK(empty > 500);
}

TEST_CASE("strokes override the segmenter") {
  SpreadCase c;
  c.mark(0, PixelHint::kObject);
  for (int x = 2; x < 12; ++x) c.marked[0].hint[std::size_t(4 * 48 + x)] = PixelHint::kBackground;
  std::fill(c.answer[0].begin(), c.answer[0].begin() + 10 * 48, std::uint8_t(1));
  const auto result = c.spread({.passes = 2});
  for (int x = 2; x < 12; ++x) CHECK(result[0].mask[std::size_t(4 * 48 + x)] == 0);
}

TEST_CASE("an empty reference mask is kNothingFound") {
  SpreadCase c;
  std::fill(c.answer[0].begin(), c.answer[0].end(), std::uint8_t(0));
  CHECK(test::code_of([&] { c.spread({}); }) == ErrorCode::kNothingFound);
}

TEST_CASE("every view with a marked object is segmented from its marks first, and its mask is never rejected") {
  SpreadCase c;
  c.mark(0, PixelHint::kObject);
  c.mark(2, PixelHint::kObject);
  std::fill(c.answer[2].begin() + 48 * 24, c.answer[2].end(), std::uint8_t(0));  // the upper half, by the marks
  const auto result = c.spread({.gate_iou = 0.9, .passes = 2});
  for (const std::size_t v : {0u, 2u}) {
    CAPTURE(v);
    REQUIRE(c.asked[v].size() == 2);
    CHECK(c.asked[v][0].by_hand);
    CHECK(c.asked[v][1].hint[20 * 48 + 24] == PixelHint::kObject);
    CHECK(result[v].source == MaskSource::kReference);
    CHECK(result[v].mask == c.answer[v]);
  }
  CHECK(result[2].agreement < 0.9);
}

TEST_CASE("a second marked view is evidence for the others") {
  SpreadCase one, two;
  two.mark(0, PixelHint::kObject);
  two.mark(2, PixelHint::kObject);
  one.has_photo[1] = two.has_photo[1] = one.has_photo[3] = two.has_photo[3] = false;
  one.answer[2] = two.answer[2] = PixelMask(48 * 40, 1);  // all of view 2: rejected in one, marked so in two
  const auto a = one.spread({.passes = 1}), b = two.spread({.passes = 1});
  CHECK(a[2].source == MaskSource::kRendered);
  CHECK(std::count(b[3].mask.begin(), b[3].mask.end(), 1) > std::count(a[3].mask.begin(), a[3].mask.end(), 1));
}

TEST_CASE("a further view with background marks only is no starting view, and its marks hold in every pass") {
  SpreadCase c;
  c.mark(0, PixelHint::kObject);
  c.mark(2, PixelHint::kBackground);
  c.spread({.passes = 2});
  REQUIRE(c.asked[2].size() == 2);
  for (const ViewPrompt& prompt : c.asked[2]) {
    CHECK_FALSE(prompt.by_hand);
    CHECK(prompt.hint[20 * 48 + 24] == PixelHint::kBackground);
  }
  SpreadCase none;
  none.mark(0, PixelHint::kBackground);
  none.mark(2, PixelHint::kBackground);
  CHECK_THROWS_WITH_AS(none.spread({}), "the marked views: only background is marked, expected the object too", Error);
}

TEST_CASE("views are processed from near to far, each next to its nearest finished view") {
  const std::vector<Camera> ring = {camera_at(1, 0, 0), camera_at(-1, 0.01, 0), camera_at(0.7, 0.7, 0),
                                    camera_at(0, 1, 0)};
  CHECK(view_order(ring, {0}, {0, 0, 0}) == std::vector<std::size_t>{0, 2, 3, 1});
  CHECK(view_order(ring, {3}, {0, 0, 0}) == std::vector<std::size_t>{3, 2, 0, 1});
  CHECK(view_order(ring, {1, 3}, {0, 0, 0}) == std::vector<std::size_t>{1, 3, 2, 0});
  CHECK(view_order({camera_at(1, 0, 0)}, {0}, {0, 0, 0}) == std::vector<std::size_t>{0});
}

}  // namespace ngs
