#include "ngs/stages/filter_probe.h"

#include <doctest/doctest.h>

#include "support/tiny_scene.h"

namespace ngs {
namespace {

/// What the probe finds where the photos were rendered with `blur_px2` over a bright background.
FilterProbe probed(double blur_px2) {
  const test::TinyScene tiny = test::tiny_scene();
  Scene scene;
  for (const Camera& camera : tiny.cameras) scene.views.emplace_back().camera = camera;
  SplatOptions splat;
  splat.blur_px2 = blur_px2;
  return probe_filter({}, tiny.cloud, scene, {0, 3}, [&](std::size_t view) {
    RenderRequest request;
    request.background = {1, 1, 0.9f};
    return render({}, tiny.cloud, scene.views[view].camera, splat, request).colour;
  });
}

}  // namespace

TEST_CASE("the filter that the photos were rendered with is found, whatever is behind the model") {
  for (const double blur : {0.3, 1.2, 0.075}) {
    CAPTURE(blur);
    CHECK(probed(blur).filter_px2 == doctest::Approx(blur));
  }
}

TEST_CASE("without views the filter is 3DGS's own") {
  CHECK(probe_filter({}, {}, {}, {}, [](std::size_t) { return ImageF(); }).filter_px2 == 0.3);
}

}  // namespace ngs
