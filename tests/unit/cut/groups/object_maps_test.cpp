// ngs/cut/groups/view_gaussians.h and object_maps.h on the tiny scene: a ball in front of a wall.
#include "ngs/cut/groups/object_maps.h"

#include <doctest/doctest.h>

#include "ngs/ops/splat/evidence.h"
#include "support/tiny_scene.h"

namespace ngs {
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
