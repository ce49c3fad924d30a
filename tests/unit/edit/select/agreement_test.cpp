#include <doctest/doctest.h>

#include "ngs/edit/select/view_agreement.h"
#include "ngs/scene/mask_threshold.h"
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

namespace {

struct Labelled {
  test::TinyScene scene = test::tiny_scene();
  Exec exec;
  SplatOptions splat = prepared_for(exec, {}, scene.cloud);
  std::vector<float> label = std::vector<float>(std::size_t(scene.cloud.size()));

  Labelled() {
    for (std::size_t i = 0; i < label.size(); i += 2) label[i] = 1;
  }
  std::vector<PixelMask> rendered() const {
    std::vector<PixelMask> masks;
    RenderRequest request{.label = {label.data(), scene.cloud.size(), 1}};
    for (const Camera& camera : scene.cameras) {
      const RenderedView view = render(exec, scene.cloud, camera, splat, request);
      PixelMask& mask = masks.emplace_back(view.label.data.size());
      for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = label_is_foreground(view.label.data[p]);
    }
    return masks;
  }
  double agreement(const std::vector<PixelMask>& masks) const {
    return view_agreement(exec, {scene.cloud, label, splat}, scene.cameras, masks);
  }
};

}  // namespace

TEST_CASE("labels agree fully with their own renders, by half with a half, and not with the opposite") {
  const Labelled model;
  const std::vector<PixelMask> masks = model.rendered();
  CHECK(model.agreement(masks) == 1);
  std::vector<PixelMask> first_only(masks.size()), opposite = masks;
  first_only[0] = masks[0];
  CHECK(model.agreement(first_only) == 1);
  CHECK(model.agreement(std::vector<PixelMask>(masks.size())) == 1);
  for (PixelMask& mask : opposite)
    for (std::uint8_t& pixel : mask) pixel = !pixel;
  CHECK(model.agreement(opposite) == 0);
  std::vector<PixelMask> half = first_only;
  std::size_t inside = 0;
  for (std::uint8_t& pixel : half[0])
    if (pixel) pixel = inside++ % 2 == 0;
  CHECK(model.agreement(half) == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("a result is worse if it contradicts more strokes, or its views more, beyond the margins") {
  const ResultQuality good{0.01, 0.95};
  CHECK_FALSE(is_worse(good, good));
  CHECK_FALSE(is_worse({0.015, 0.94}, good));
  CHECK(is_worse({0.03, 0.99}, good));
  CHECK(is_worse({0.0, 0.9}, good));
  CHECK_FALSE(is_worse({0.0, 0.99}, good));
}

TEST_CASE("boundary Gaussians of the trained labels get the first labels, and no other Gaussian does") {
  LabelColumns first, trained;
  first.label = {1, 0, 1, 0};
  first.boundary = {0, 0, 1, 1};
  trained.label = {0, 1, 0, 1};
  trained.boundary = {1, 1, 0, 0};
  const std::vector<float> fixed = fix_boundary(first, trained);
  CHECK(fixed == std::vector<float>{1, 1, 0, 0});
  CHECK(trained.label.values() == std::vector<float>{1, 0, 0, 1});
}

}  // namespace ngs
