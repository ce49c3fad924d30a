// ngs/cut/groups/grouped_objects.h: votes and figures by hand, Gaussians 0-19 (object A) and 20-29 (B).
#include "ngs/cut/groups/grouped_objects.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "ngs/cut/groups/object_maps.h"
#include "ngs/ops/splat/evidence.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

/// Gaussian i lies in mask[i / 10] with weight 1.
ViewGaussians view_of(int masks, std::vector<std::uint32_t> mask) {
  ViewGaussians view{masks, {}};
  for (std::uint32_t i = 0; i < 30; ++i) view.seen.push_back({i, mask[i / 10], 1.f, 1.f});
  return view;
}
std::vector<ViewGaussians> views_of_both(int count) {
  return std::vector<ViewGaussians>(std::size_t(count), view_of(2, {1, 1, 2}));
}
GroupedObjects found_in(const std::vector<ViewGaussians>& views, const ObjectOptions& options = {}) {
  const Exec exec;
  return objects_of_groups(exec, options, 31, views, group_masks(exec, {}, views));
}

}  // namespace

TEST_CASE("objects are numbered by size, and a Gaussian that no view sees has none") {
  std::vector<ViewGaussians> views(4, view_of(2, {1, 2, 2}));  // the second mask is the larger one
  const GroupedObjects found = found_in(views);
  REQUIRE(found.sure == 2);
  CHECK(found.objects[0].gaussians == 20);
  CHECK(found.objects[0].confidence == 1);
  CHECK(found.objects[0].views.size() == 4);
  CHECK(found.object[0] == 2);
  CHECK(found.object[10] == 1);
  CHECK(found.object[30] == 0);
}

TEST_CASE("a Gaussian gets the object that most views show it in") {
  std::vector<ViewGaussians> views = views_of_both(5);
  for (std::size_t v : {0u, 1u}) views[v].seen[3].mask = 2;      // 2 of 5 views
  for (std::size_t v : {0u, 1u, 2u}) views[v].seen[4].mask = 2;  // 3 of 5
  for (std::size_t v : {2u, 3u, 4u}) views[v].seen[5].mask = 0;
  const GroupedObjects found = found_in(views);
  REQUIRE(found.sure == 2);
  CHECK(found.object[3] == 1);
  CHECK(found.object[4] == 2);
  CHECK(found.object[5] == 0);
}

TEST_CASE("an object of too few views or Gaussians is doubtful, behind the sure ones") {
  std::vector<ViewGaussians> views = views_of_both(4);
  ObjectOptions options{.min_gaussians = 11};
  const GroupedObjects small = found_in(views, options);
  CHECK(small.sure == 1);
  REQUIRE(small.objects.size() == 2);
  CHECK(small.objects[1].gaussians == 10);
  CHECK(small.object[25] == 2);
  options.min_views = 5;
  CHECK(found_in(views, options).sure == 0);
  CHECK(found_in({}).objects.empty());
}

TEST_CASE("five hundred objects, numbered differently in each view, are found") {
  constexpr std::uint32_t kObjects = 500, kEach = 10;
  std::vector<ViewGaussians> views(4, ViewGaussians{int(kObjects), {}});
  for (std::uint32_t v = 0; v < views.size(); ++v)
    for (std::uint32_t i = 0; i < kObjects * kEach; ++i)
      views[v].seen.push_back({i, 1 + (7 * (i / kEach) + 131 * v) % kObjects, 1.f, 1.f});
  const Exec exec;
  const GroupedObjects found = objects_of_groups(exec, {}, kObjects * kEach, views, group_masks(exec, {}, views));
  REQUIRE(found.sure == kObjects);
  std::vector<std::uint32_t> first(kObjects + 1);
  for (std::uint32_t i = 0; i < kObjects * kEach; ++i) {
    REQUIRE(found.object[i] > 0);
    CHECK(found.object[i] == found.object[i - i % kEach]);
    if (i % kEach == 0) ++first[found.object[i]];
  }
  CHECK(std::ranges::count(first, 1u) == kObjects);
}

TEST_CASE("an object that some views have in the mask of another is part of it") {
  std::vector<ViewGaussians> views = views_of_both(5);
  for (std::size_t v : {0u, 1u}) {
    views[v].masks = 1;
    for (MaskedGaussian& of : views[v].seen) of.mask = 1;
  }
  const GroupedObjects found = found_in(views);
  REQUIRE(found.sure == 2);
  CHECK(found.objects[1].part_of == 1);
  CHECK(found.objects[1].part_share == doctest::Approx(0.4));
  CHECK(found.objects[1].confidence == doctest::Approx(0.6));
  CHECK(found.objects[0].part_of == 0);
}

TEST_CASE("the content of a mask is the object with most of its weight") {
  std::vector<ViewGaussians> views = views_of_both(4);
  const GroupedObjects found = found_in(views);
  const ViewGaussians one = view_of(2, {1, 0, 1});
  const std::vector<MaskContent> content = mask_contents(one, found);
  REQUIRE(content.size() == 3);
  CHECK(content[1].share == doctest::Approx(0.5));
  CHECK(content[0].object == 1);
  CHECK(content[0].share == 1);
  CHECK_FALSE(content[2].is_known);
}

// ngs/cut/groups/view_gaussians.h and object_maps.h on the tiny scene: a ball in front of a wall.

namespace {

/// Rectangles, `count` in a row and in a column, numbered from 1.
NumberedMasks rectangles(const Camera& camera, int count) {
  NumberedMasks masks{ImageU16(camera.width_px, camera.height_px, 1), count * count};
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x)
      masks.number.at(x, y) = std::uint16_t(y * count / camera.height_px * count + x * count / camera.width_px + 1);
  return masks;
}

/// The ball is object 1.
GroupedObjects ball_of(const test::TinyScene& scene) {
  GroupedObjects objects;
  for (const float is_ball : scene.is_object) objects.object.push_back(is_ball > 0 ? 1 : 0);
  objects.objects.resize(1);
  objects.sure = 1;
  return objects;
}

}  // namespace

TEST_CASE("the mask of a Gaussian is the one with more than half of its weight, for more masks than fit in one pass") {
  const test::TinyScene scene = test::tiny_scene();
  const Camera camera = resized(scene.cameras[0], 480, 360);
  const NumberedMasks masks = rectangles(camera, 9);
  ViewMasks planes = known_view(camera);
  planes.target.assign(std::size_t(masks.masks), std::vector<float>(masks.number.data.size()));
  for (std::size_t p = 0; p < masks.number.data.size(); ++p) planes.target[masks.number.data[p] - 1u][p] = 1;
  const ViewSums sums = view_sums({}, scene.cloud, {camera, planes}, {});
  std::vector<MaskedGaussian> expected;
  for (std::size_t v = 0; v < sums.size(); ++v)
    for (std::size_t k = 0; k < planes.target.size(); ++k)
      if (sums.object_weight(v, k) > 0.5 * sums.weight(v))
        expected.push_back({sums.row[v], std::uint32_t(k + 1), float(sums.weight(v)), 0});
  const ViewGaussians found = view_gaussians({}, scene.cloud, camera, {}, masks);
  REQUIRE(found.seen.size() == expected.size());
  REQUIRE(expected.size() > 20);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    CHECK(found.seen[i].gaussian == expected[i].gaussian);
    CHECK(found.seen[i].mask == expected[i].mask);
    CHECK(found.seen[i].weight == expected[i].weight);
  }
}

TEST_CASE("pixels without a mask and unknown pixels: Gaussians are outside, or not counted") {
  const test::TinyScene scene = test::tiny_scene();
  const Camera& camera = scene.cameras[0];
  NumberedMasks masks{ImageU16(camera.width_px, camera.height_px, 1), 0};
  const ViewGaussians outside = view_gaussians({}, scene.cloud, camera, {}, masks);
  REQUIRE(outside.seen.size() > 100);
  for (const MaskedGaussian& of : outside.seen) CHECK(of.mask == 0);
  masks.number.data.assign(masks.number.data.size(), NumberedMasks::kUnknown);
  CHECK(view_gaussians({}, scene.cloud, camera, {}, masks).seen.empty());
  CHECK(view_gaussians({}, scene.cloud, camera, {}, {}).seen.empty());
}

TEST_CASE("Gaussians hidden in a view are removed from it") {
  std::vector<ViewGaussians> views = {{1, {{0, 1, 5.f, 0.9f}, {1, 1, 5.f, 0.2f}}}, {1, {{0, 1, 5.f, 0.2f}}}};
  keep_unhidden({}, 2, 0.3, views);
  CHECK(views[0].seen.size() == 2);  // the second Gaussian is never more visible
  CHECK(views[1].seen.empty());
}

TEST_CASE("a mask of one object gets its number; one of several, and pixels without a mask, as rendered") {
  const test::TinyScene scene = test::tiny_scene();
  const Camera& camera = scene.cameras[2];
  const GroupedObjects objects = ball_of(scene);
  const SplatOptions splat;
  const ObjectMaps maps({}, scene.cloud, splat, objects);
  const ImageU16 ball = maps.rendered({}, camera);
  REQUIRE(std::ranges::count(ball.data, 1) > 50);
  const auto corrected = [&](const NumberedMasks& masks) {
    return maps.corrected({}, camera, view_gaussians({}, scene.cloud, camera, splat, masks), masks);
  };
  NumberedMasks wide{ImageU16(camera.width_px, camera.height_px, 1), 1};  // the ball and as much of the wall
  int top = camera.height_px, bottom = 0, left = camera.width_px, right = 0;
  for (int y = 0; y < camera.height_px; ++y)
    for (int x = 0; x < camera.width_px; ++x) {
      if (ball.at(x, y) == 0) continue;
      top = std::min(top, y);
      bottom = std::max(bottom, y);
      left = std::min(left, x);
      right = std::max(right, x);
    }
  constexpr int kMargin = 4;
  for (int y = std::max(0, top - kMargin); y <= std::min(camera.height_px - 1, bottom + kMargin); ++y)
    for (int x = std::max(0, left - kMargin); x <= std::min(camera.width_px - 1, right + kMargin); ++x)
      wide.number.at(x, y) = 1;
  const MaskContent content = mask_contents(view_gaussians({}, scene.cloud, camera, splat, wide), objects)[1];
  REQUIRE(content.share < ObjectMaps::kOneObject);
  CHECK(corrected(wide).data == ball.data);
  NumberedMasks exact{ball, 1};
  CHECK(corrected(exact).data == ball.data);
  const NumberedMasks none{ImageU16(camera.width_px, camera.height_px, 1), 0};
  const ImageU16 without = corrected(none);
  for (std::size_t p = 0; p < ball.data.size(); ++p)
    CHECK(without.data[p] == (ball.data[p] == 1 ? NumberedMasks::kUnknown : 0));
  GroupedObjects doubtful = objects;
  doubtful.sure = 0;
  const ObjectMaps of_doubtful({}, scene.cloud, splat, doubtful);
  const ImageU16 unsure =
      of_doubtful.corrected({}, camera, view_gaussians({}, scene.cloud, camera, splat, exact), exact);
  CHECK(std::ranges::count(unsure.data, NumberedMasks::kUnknown) == std::ranges::count(ball.data, 1));
}

}  // namespace ngs
