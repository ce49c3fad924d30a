#include "ngs/capture/filter_probe.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "support/tiny_scene.h"

namespace ngs {
namespace {

struct Probed {
  FilterProbe found;
  std::int64_t passes = 0, told = 0, of = 0;
};

/// The result of the probe for photos rendered with `splat` over a bright background, and its number of renders.
Probed probed(const SplatOptions& splat) {
  const test::TinyScene tiny = test::tiny_scene();
  Scene scene;
  for (const Camera& camera : tiny.cameras) scene.views.emplace_back().camera = camera;
  scene.antialiased = splat.antialiased;
  Probed probed;
  Monitor monitor;
  monitor.on_progress = [&](const std::string&, std::int64_t done, std::int64_t total) {
    probed.told = done, probed.of = total;
  };
  const auto load_photo = [&](std::size_t view) {
    ++probed.passes;
    RenderRequest request;
    request.background = {1, 1, 0.9f};
    return render({}, tiny.cloud, scene.views[view].camera, splat, request).colour;
  };
  probed.found = probe_filter({}, monitor, {tiny.cloud, scene, load_photo}, {0, 3});
  return probed;
}

}  // namespace

TEST_CASE("the probe finds the filter of the photos, for any background") {
  for (const double blur : {0.3, 4.8, 1.2, 0.075, 0.01875}) {
    CAPTURE(blur);
    for (const bool antialiased : {false, true})
      CHECK(probed({.antialiased = antialiased, .blur_px2 = blur}).found.filter_px2 == doctest::Approx(blur));
  }
}

TEST_CASE("the probe continues only on the side with the higher PSNR") {
  const auto tried = [](double blur) {
    const Probed p = probed({.blur_px2 = blur});
    CHECK(p.passes == 2 * std::int64_t(p.found.candidates.size()));  // of two views
    CHECK(p.told == p.passes);
    CHECK(p.of == p.passes);
    std::vector<double> filters;
    for (const FilterCandidate& c : p.found.candidates) filters.push_back(c.filter_px2);
    return filters;
  };
  CHECK(tried(0.3) == std::vector<double>{0.3, 1.2, 0.075});
  CHECK(tried(1.2) == std::vector<double>{0.3, 1.2, 4.8});
  CHECK(tried(0.075) == std::vector<double>{0.3, 1.2, 0.075, 0.01875});
}

TEST_CASE("without views the filter is that of 3DGS") {
  Monitor monitor;
  const GaussianCloud cloud;
  const Scene scene;
  const FilterProbe probe = probe_filter({}, monitor, {cloud, scene, [](std::size_t) { return ImageF(); }}, {});
  CHECK(probe.filter_px2 == 0.3);
  CHECK(probe.candidates.empty());
}

}  // namespace ngs
