// ngs/problem/coarse_input.h: photos, masks and cameras at a reduced size match each other.
#include "ngs/problem/coarse_input.h"

#include <doctest/doctest.h>

#include <atomic>

#include "ngs/problem/view_list.h"
#include "support/joint_case.h"

namespace ngs {

TEST_CASE("a reduced photo has the means of its cells, and its camera projects points to the same place") {
  const auto c = test::joint_case();
  Problem fine = c->input();
  const CoarseInput coarse(fine, 3);
  const Camera& big = fine.scene.views[0].camera;
  const Camera& small = coarse.get().scene.views[0].camera;
  CHECK(small.width_px == (big.width_px + 2) / 3);
  CHECK(3 * small.cx == doctest::Approx(big.cx));
  CHECK(3 * small.fx == doctest::Approx(big.fx));
  CHECK(coarse.get().splat.blur_px2 == doctest::Approx(fine.splat.blur_px2 / 9));
  const ImageF photo = fine.load_photo(0), cells = coarse.get().load_photo(0);
  REQUIRE(cells.width_px == small.width_px);
  REQUIRE(cells.height_px == small.height_px);
  double mean = 0;
  for (int v = 3; v < 6; ++v)
    for (int u = 6; u < 9; ++u) mean += double(photo.at(u, v, 1)) / 9;
  CHECK(double(cells.at(2, 1, 1)) == doctest::Approx(mean));
  const int last = cells.width_px - 1;  // a cell on the rim has fewer pixels
  double rim = 0;
  for (int v = 0; v < 3; ++v)
    for (int u = 3 * last; u < photo.width_px; ++u) rim += double(photo.at(u, v, 0));
  CHECK(double(cells.at(last, 0, 0)) == doctest::Approx(rim / (3 * (photo.width_px - 3 * last))));
}

TEST_CASE("a cell of a mask is unknown if one of its pixels is, and a view without a mask has none") {
  const auto c = test::joint_case();
  Problem fine = c->input();
  ViewMasks masks = c->masks[0];
  masks.known.assign(masks.target[0].size(), 1);
  masks.known[0] = 0;
  fine.load_masks = [&](std::size_t v) { return v == 0 ? masks : ViewMasks{}; };
  const CoarseInput coarse(fine, 2);
  const ViewMasks half = coarse.get().load_masks(0);
  REQUIRE(half.available);
  REQUIRE(half.known.size() == half.target[0].size());
  CHECK(half.known[0] == 0);
  CHECK(half.known[1] == 1);
  CHECK(half.target[0][1] ==
        doctest::Approx((masks.target[0][2] + masks.target[0][3] + masks.target[0][std::size_t(masks.width_px) + 2] +
                         masks.target[0][std::size_t(masks.width_px) + 3]) /
                        4));
  CHECK_FALSE(coarse.get().load_masks(1).available);
}

TEST_CASE("shrink 1 leaves images unchanged and loads them once, until the cache is cleared") {
  const auto c = test::joint_case();
  Problem fine = c->input();
  int loads = 0;
  fine.load_photo = [&, load = fine.load_photo](std::size_t v) { return ++loads, load(v); };
  CoarseInput same(fine, 1);
  CHECK(same.get().load_photo(2).data == c->input().load_photo(2).data);
  CHECK(same.get().load_photo(2).width_px == c->input().load_photo(2).width_px);
  CHECK(loads == 1);
  same.clear_cache();
  for (int again = 0; again < 2; ++again) CHECK(same.get().load_photo(2).data == c->input().load_photo(2).data);
  CHECK(loads == 3);  // the cache is disabled
}

TEST_CASE("preload by several threads loads each image once and gives the same values") {
  const auto c = test::joint_case();
  for (SceneView& view : c->scene.views) view.image_path = view.camera.name;
  Problem fine = c->input();
  std::atomic<int> loads = 0;
  fine.load_photo = [&, load = fine.load_photo](std::size_t v) { return ++loads, load(v); };
  fine.load_masks = [&, load = fine.load_masks](std::size_t v) { return ++loads, load(v); };
  const CoarseInput ahead(fine, 2), later(fine, 2);
  ahead.preload({.threads = 3});
  const int expected = int(photo_views(fine.scene).size() + fine.views.size());
  CHECK(loads == expected);
  for (const std::size_t v : fine.views) {
    CHECK(ahead.get().load_photo(v).data == later.get().load_photo(v).data);
    CHECK(ahead.get().load_masks(v).target == later.get().load_masks(v).target);
  }
  CHECK(loads == expected + 2 * int(fine.views.size()));
}

TEST_CASE("preload stops when its callback returns false, and other images are loaded on demand") {
  const auto c = test::joint_case();
  for (SceneView& view : c->scene.views) view.image_path = view.camera.name;
  Problem fine = c->input();
  int loads = 0;
  fine.load_photo = [&, load = fine.load_photo](std::size_t v) { return ++loads, load(v); };
  fine.load_masks = [&, load = fine.load_masks](std::size_t v) { return ++loads, load(v); };
  const CoarseInput some(fine, 2), all(fine, 2);
  const double all_images = double(photo_views(fine.scene).size() + fine.views.size());
  CHECK(some.preload({}, [&] { return loads < 2; }) == doctest::Approx(2 / all_images));
  CHECK(loads == 2);
  CHECK(all.preload({}, [] { return true; }) == 1);
  for (const std::size_t v : fine.views) CHECK(some.get().load_photo(v).data == all.get().load_photo(v).data);
}

TEST_CASE("masks of many objects stay in the cache if their run lengths fit") {
  const auto c = test::joint_case();
  Problem fine = c->input();
  ViewMasks many = c->masks[0];
  many.target.assign(50, c->masks[0].target[0]);
  int loads = 0;
  fine.load_masks = [&](std::size_t) { return ++loads, many; };
  const std::size_t plane_bytes = many.target[0].size() * sizeof(float);
  const CoarseInput large(fine, 1, 20 * plane_bytes), none(fine, 1, 0);
  for (int visit = 0; visit < 3; ++visit) CHECK(large.get().load_masks(0).target == many.target);
  CHECK(loads == 1);
  for (int visit = 0; visit < 3; ++visit) CHECK(none.get().load_masks(0).target == many.target);
  CHECK(loads == 4);
}

}  // namespace ngs
