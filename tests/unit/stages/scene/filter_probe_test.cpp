#include "ngs/stages/scene/filter_probe.h"

#include <doctest/doctest.h>

#include "support/tiny_scene.h"

namespace ngs {
namespace {

/// What the probe finds where the photos were rendered so over a bright background.
FilterProbe probed(const SplatOptions& splat) {
  const test::TinyScene tiny = test::tiny_scene();
  Scene scene;
  for (const Camera& camera : tiny.cameras) scene.views.emplace_back().camera = camera;
  scene.antialiased = splat.antialiased;
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
    for (const bool antialiased : {false, true})
      CHECK(probed({.antialiased = antialiased, .blur_px2 = blur}).filter_px2 == doctest::Approx(blur));
  }
}

TEST_CASE("without views the filter is 3DGS's own") {
  CHECK(probe_filter({}, {}, {}, {}, [](std::size_t) { return ImageF(); }).filter_px2 == 0.3);
}

}  // namespace ngs
