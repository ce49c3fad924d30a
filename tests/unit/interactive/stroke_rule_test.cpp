#include "support/stroke_rule.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/cut/masks/rasterise_prompt.h"
#include "ngs/interactive/viewpoint.h"
#include "ngs/ops/splat/splat.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

constexpr int kStrokeWidth_px = 200, kStrokeHeight_px = 150;

/// A bar of 20 px across the picture's middle, with a knob at its left end.
PixelMask bar(int left) {
  PixelMask mask(std::size_t(kStrokeWidth_px * kStrokeHeight_px));
  for (int y = 0; y < kStrokeHeight_px; ++y)
    for (int x = 0; x < kStrokeWidth_px; ++x)
      mask[std::size_t(y * kStrokeWidth_px + x)] =
          (x >= left && x < 160 && std::abs(y - 75) < 10) || std::hypot(x - left - 15.0, y - 75.0) < 15;
  return mask;
}

TEST_CASE("the rule draws one line within the object and one around it, at its distance") {
  const PixelMask truth = bar(40);
  const HandPrompt prompt = test::strokes_of_truth(truth, kStrokeWidth_px, kStrokeHeight_px, "0000.png");
  REQUIRE(prompt.strokes.size() == 2);
  CHECK(prompt.view == "0000.png");
  CHECK(prompt.strokes[0].object);
  CHECK_FALSE(prompt.strokes[1].object);
  const auto& line = prompt.strokes[0].points;
  CHECK(std::hypot(line[1][0] - line[0][0], line[1][1] - line[0][1]) > 90);  // along the bar, not across it
  const ViewPrompt hints = rasterise(prompt, kStrokeWidth_px, kStrokeHeight_px);
  int wrong = 0, marked[2] = {};
  for (std::size_t p = 0; p < truth.size(); ++p) {
    if (!is_certain(hints.hint[p])) continue;
    ++marked[is_object(hints.hint[p])];
    wrong += is_object(hints.hint[p]) != (truth[p] != 0);
  }
  CHECK(wrong == 0);
  CHECK(marked[0] > 500);
  CHECK(marked[1] > 300);
}

TEST_CASE("in a small picture the line around an object stays off it") {
  constexpr int kSmallWidth = 112, kSmallHeight = 84;
  PixelMask truth(std::size_t(kSmallWidth * kSmallHeight));
  for (int y = 0; y < kSmallHeight; ++y)
    for (int x = 0; x < kSmallWidth; ++x) truth[std::size_t(y * kSmallWidth + x)] = std::hypot(x - 56.0, y - 42.0) < 20;
  const HandPrompt prompt = test::strokes_of_truth(truth, kSmallWidth, kSmallHeight, "0000.png");
  const ViewPrompt hints = rasterise(prompt, kSmallWidth, kSmallHeight);
  int wrong = 0, marked = 0;
  for (std::size_t p = 0; p < truth.size(); ++p)
    if (is_certain(hints.hint[p])) {
      ++marked;
      wrong += is_object(hints.hint[p]) != (truth[p] != 0);
    }
  CHECK(marked > 200);
  CHECK(wrong == 0);
}

TEST_CASE("the line around an object that the frame cuts has no point on the frame") {
  const HandPrompt prompt = test::strokes_of_truth(bar(-20), kStrokeWidth_px, kStrokeHeight_px, "0000.png");
  for (const PromptStroke& stroke : prompt.strokes)
    if (!stroke.object)
      for (const auto& point : stroke.points) CHECK(point[0] > 0);
}

TEST_CASE("nothing to mark gives no stroke") {
  CHECK(test::strokes_of_truth(PixelMask(std::size_t(kStrokeWidth_px * kStrokeHeight_px)), kStrokeWidth_px,
                               kStrokeHeight_px, "v")
            .strokes.empty());
}

}  // namespace

TEST_CASE("the camera of a viewpoint has look_at at its middle pixel and up upwards") {
  live::Viewpoint viewpoint{{1, 2, 3}, {4, 0, -2}, {0, 0, 1}, 60, 320, 240};
  const Camera camera = live::camera_of(viewpoint);
  const auto pixel = [&](Vec3<double> p) {
    const Vec3<double> at = camera.rotation * p + camera.translation;
    REQUIRE(at.z > 0);
    return Vec2<double>{camera.fx * at.x / at.z + camera.cx, camera.fy * at.y / at.z + camera.cy};
  };
  const Vec2<double> middle = pixel(viewpoint.look_at), above = pixel(viewpoint.look_at + Vec3<double>{0, 0, 0.1});
  CHECK(middle.x == doctest::Approx(160));
  CHECK(middle.y == doctest::Approx(120));
  CHECK(above.y < middle.y);
  CHECK(above.x == doctest::Approx(160));
  CHECK(std::atan(120 / camera.fy) == doctest::Approx(30 * 3.14159265358979 / 180));
  viewpoint.up = viewpoint.look_at - viewpoint.position;
  CHECK(std::isfinite(live::camera_of(viewpoint).rotation(0, 0)));
  viewpoint.look_at = viewpoint.position;
  CHECK_THROWS_AS(live::camera_of(viewpoint), Error);
}

TEST_CASE("the first viewpoint at a model shows the model") {
  GaussianCloud cloud;
  test::add_sphere(cloud, {3, -1, 7}, 0.5, 700);
  const live::InitialViewpoint first = live::initial_viewpoint({}, cloud);
  const Vec3<double> off = first.centre - Vec3<double>{3, -1, 7};
  CHECK(std::sqrt(dot(off, off)) < 0.1);
  CHECK(first.radius == doctest::Approx(0.5).epsilon(0.3));
  const RenderedView view = render({}, cloud, live::camera_of(first.viewpoint), {.world_unit = first.world_unit}, {});
  double covered = 0;
  for (const float alpha : view.alpha.data) covered += double(alpha) / double(view.alpha.data.size());
  CHECK(covered > 0.1);
  CHECK_THROWS_AS(live::initial_viewpoint({}, GaussianCloud()), Error);
}

}  // namespace ngs
