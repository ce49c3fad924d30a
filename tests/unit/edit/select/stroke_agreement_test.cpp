#include <doctest/doctest.h>

#include "ngs/edit/select/view_agreement.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

ViewPrompt marks_on(const Camera& camera) {
  return {camera.width_px, camera.height_px,
          std::vector<PixelHint>(std::size_t(camera.width_px) * std::size_t(camera.height_px),
                                 PixelHint::kLikelyBackground),
          true};
}

void dab(ViewPrompt& marks, int x, int y, PixelHint hint) {
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u) marks.hint[std::size_t(v * marks.width_px + u)] = hint;
}

}  // namespace

TEST_CASE("strokes on the right side agree, and a background stroke inside the object is reported with its position") {
  const test::TinyScene scene = test::tiny_scene();
  const Camera& camera = scene.cameras[2];
  ViewPrompt marks = marks_on(camera);
  dab(marks, 24, 17, PixelHint::kObject);  // the ball
  dab(marks, 4, 4, PixelHint::kBackground);
  StrokeAgreement found;
  add_stroke_agreement({}, {scene.cloud, scene.is_object, {}}, camera, marks, found);
  CHECK(found.pixels == 18);
  CHECK(found.wrong == 0);
  CHECK(found.broken.empty());
  dab(marks, 24, 22, PixelHint::kBackground);
  StrokeAgreement broken;
  add_stroke_agreement({}, {scene.cloud, scene.is_object, {}}, camera, marks, broken);
  REQUIRE(broken.broken.size() == 1);
  CHECK_FALSE(broken.broken[0].object);
  CHECK(broken.broken[0].view == camera.name);
  CHECK(broken.broken[0].x == 23);
  CHECK(broken.broken[0].y == 21);
  CHECK(broken.broken[0].wrong == 1);
  CHECK(broken.wrong_share() == doctest::Approx(9.0 / 27));
}

TEST_CASE("background strokes on empty pixels agree with any labels") {
  test::TinyScene scene = test::tiny_scene();
  for (float& logit : scene.cloud.logit_opacity) logit = -12;
  const std::vector<float> all(scene.is_object.size(), 1.f);
  ViewPrompt marks = marks_on(scene.cameras[0]);
  dab(marks, 10, 10, PixelHint::kBackground);
  StrokeAgreement found;
  add_stroke_agreement({}, {scene.cloud, all, {}}, scene.cameras[0], marks, found);
  CHECK(found.pixels == 0);
  CHECK(found.wrong_share() == 0);
}

}  // namespace ngs
