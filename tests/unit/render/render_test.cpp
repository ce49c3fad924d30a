#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "ngs/render/render_options.h"
#include "ngs/render/render_stage.h"
#include "ngs/scene/mask_threshold.h"
#include "support/cameras.h"
#include "support/splat_shapes.h"

namespace ngs {
namespace {

/// A wall of Gaussians across the image, with soft labels on a disc.
struct SoftObject {
  GaussianCloud cloud;
  std::vector<LabelColumns> objects{1};
  Camera camera = test::camera_along_z(160, 140, 130);

  SoftObject() {
    constexpr int kSide = 60;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> jitter(-0.02f, 0.02f);
    for (LabelColumn LabelColumns::*const column : kLabelColumns) (objects[0].*column).assign(kSide * kSide, 0.f);
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
      const std::size_t column = i % kSide, row = i / kSide;
      const float x = 0.05f * (float(column) - 30), y = 0.05f * (float(row) - 30);
      test::add_gaussian(cloud, {x + jitter(random), y + jitter(random), 3 + 5 * jitter(random)}, 0.03, {}, 2);
      const float r = std::hypot(x + 0.6f, y);
      objects[0].label[i] = std::exp(-10 * r * r) + 10 * jitter(random) * jitter(random);
    }
  }
};

}  // namespace

TEST_CASE("masks of soft labels equal the thresholded labels at every pixel, and are 0 far from the object") {
  const SoftObject c;
  const LabelChannels channels({}, c.cloud, c.objects);
  const ImageF view = channels.view({}, c.camera, {}), masks = channels.masks({}, c.camera, {});
  int object = 0, soft = 0, not_drawn = 0;
  for (std::size_t p = 0; p < view.data.size(); ++p) {
    CHECK(label_is_foreground(view.data[p]) == label_is_foreground(masks.data[p]));
    CHECK((masks.data[p] == view.data[p] || masks.data[p] == 0));
    object += label_is_foreground(view.data[p]);
    soft += view.data[p] > 0.1f && view.data[p] < 0.45f;
    not_drawn += masks.data[p] != view.data[p];
  }
  CHECK(object > 200);
  CHECK(soft > 200);
  CHECK(not_drawn > 5000);
}

TEST_CASE("labels alone are bit-identical to those of the whole view, also if tiles without labels are skipped") {
  SoftObject c;
  LabelColumn& label = c.objects[0].label;
  for (std::size_t i = 0; i < label.size(); ++i)
    if (label[i] < 0.5f) label[i] = 0;
  const ImageF alone = LabelChannels({}, c.cloud, c.objects).view({}, c.camera, {});
  CHECK(alone.data == render_labelled({}, {c.cloud, c.objects}, c.camera, {}).label.data);
  CHECK(std::ranges::count(alone.data, 0.f) > 5000);
  LabelledRequest colour{.depth = false, .labels = false};
  const RenderedView coloured = render_labelled({}, {c.cloud, c.objects}, c.camera, colour);
  CHECK(coloured.colour.data == render_labelled({}, {c.cloud, c.objects}, c.camera, {}).colour.data);
  CHECK(coloured.label.empty());
  CHECK(coloured.depth.empty());
}

TEST_CASE("splat options come from the options, else from the scene, else from the PLY") {
  Scene scene;
  GaussianCloud cloud;
  cloud.antialiased = true;
  CHECK(splat_options({}, cloud, scene).compat == Compat::kInria);
  CHECK(splat_options({}, cloud, scene).antialiased);
  scene.compat = Compat::kGsplat;
  scene.antialiased = false;
  CHECK(splat_options({}, cloud, scene).compat == Compat::kGsplat);
  CHECK_FALSE(splat_options({}, cloud, scene).antialiased);
  CHECK(splat_options({.compat = CompatChoice::kInria}, cloud, scene).compat == Compat::kInria);
  CHECK(splat_options({.antialias = Antialias::kOn}, cloud, scene).antialiased);
  scene.compat = Compat::kInria;
  CHECK(splat_options({.compat = CompatChoice::kGsplat}, cloud, scene).compat == Compat::kGsplat);
}

}  // namespace ngs
