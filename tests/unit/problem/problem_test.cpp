#include "ngs/problem/problem.h"

#include <doctest/doctest.h>

#include <atomic>

#include "ngs/problem/coarse_input.h"
#include "ngs/problem/view_list.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// A problem with a value in every optional member.
Problem full(const test::JointCase& c, Monitor& monitor) {
  Problem problem = c.input();
  const auto n = std::size_t(c.model.size());
  problem.rule = {.tau = 0.3, .criterion = Criterion::kBetweenViews};
  problem.background = {0.1f, 0.2f, 0.3f};
  problem.seed = 7;
  problem.fixed.assign(n, 1.f);
  problem.frozen.assign(n, 1);
  problem.region.assign(n, 1);
  problem.weight = std::make_shared<const std::vector<float>>(n, 2.f);
  problem.load_fine_photo = problem.load_photo;
  problem.window_share.assign(c.scene.views.size(), 0.5);
  problem.uncropped = std::make_shared<const Problem>(c.input());
  problem.owns.push_back(std::make_shared<int>(1));
  problem.monitor = &monitor;
  return problem;
}

void check_rest(const Problem& next, const Problem& from) {
  CHECK(next.views == from.views);
  CHECK(next.background.y == from.background.y);
  CHECK(next.seed == from.seed);
  CHECK(next.fixed == from.fixed);
  CHECK(next.rule == from.rule);
  CHECK(next.frozen == from.frozen);
  CHECK(next.region == from.region);
  CHECK(bool(next.load_fine_photo));
  CHECK(next.uncropped == from.uncropped);
  CHECK(next.monitor == from.monitor);
}

}  // namespace

TEST_CASE("problem: with_model() replaces model and labels, clears the weight, and keeps all other members") {
  const auto c = test::joint_case();
  Monitor monitor;
  const Problem from = full(*c, monitor);
  std::weak_ptr<const GaussianCloud> model;
  {
    auto other = std::make_shared<const GaussianCloud>(c->model);
    model = other;
    const Problem next = from.with_model(std::move(other), {LabelColumns{}});
    CHECK(&next.cloud == model.lock().get());
    CHECK(&next.scene == &from.scene);
    CHECK(next.labels.size() == 1);
    CHECK(next.weight == nullptr);
    CHECK(next.window_share == from.window_share);
    CHECK(next.owns.size() == 2);
    check_rest(next, from);
  }
  CHECK(model.expired());  // only the problem owned it
}

TEST_CASE("problem: with_views() replaces cameras and loaders; cropped() also clears the weight") {
  const auto c = test::joint_case();
  Monitor monitor;
  const Problem from = full(*c, monitor);
  const Scene scene = c->scene;
  const auto masks = [](std::size_t) { return ViewMasks{3, 2, {}, {}, true}; };
  const auto photo = [](std::size_t) { return ImageF(3, 2, 3); };
  const Problem seen = from.with_views(scene, masks, photo), part = from.cropped(scene, masks, photo, {0.25});
  for (const Problem* next : {&seen, &part}) {
    CHECK(&next->cloud == &from.cloud);
    CHECK(&next->scene == &scene);
    CHECK(next->load_masks(0).width_px == 3);
    CHECK(next->load_photo(0).width_px == 3);
    check_rest(*next, from);
  }
  CHECK(seen.weight == from.weight);
  CHECK(seen.window_share == from.window_share);
  CHECK(part.weight == nullptr);
  CHECK(part.window_share == std::vector<double>{0.25});
}

TEST_CASE("spread_views returns distinct views, evenly spread, at most as many as there are") {
  using List = std::vector<std::size_t>;
  CHECK(spread_views({}, 3).empty());
  CHECK(spread_views({4, 7}, 3) == List{4, 7});
  CHECK(spread_views({4, 7, 9}, 3) == List{4, 7, 9});
  CHECK(spread_views({0, 1, 2, 3, 4, 5, 6}, 3) == List{0, 2, 4});
}

// ngs/problem/coarse_input.h: photos, masks and cameras at a reduced size match each other.

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
