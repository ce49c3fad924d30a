#include "ngs/capture/filter_probe.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "support/checked_capture.h"
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
    probed.told = done;
    probed.of = total;
  };
  const auto load_photo = [&](std::size_t view) {
    ++probed.passes;
    RenderRequest request{.label = {}, .background = {1, 1, 0.9f}};
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
  const GaussianCloud cloud;
  const Scene scene;
  const FilterProbe probe = probe_filter({}, test::Quiet(), {cloud, scene, [](std::size_t) { return ImageF(); }}, {});
  CHECK(probe.filter_px2 == 0.3);
  CHECK(probe.candidates.empty());
}

// Near planes of small worlds, and the renderer that matches the photos.

namespace {

using test::Capture;
using test::shrunk;
using test::thrown_by;
using test::tiny_capture;

}  // namespace

TEST_CASE("another scene's model in a small world gets no hint about near planes") {
  Capture other = shrunk(1e-3);
  for (ImageF& photo : other.photos)
    for (int y = 0; y < photo.height_px; ++y)
      for (int x = 0; x < photo.width_px; ++x)
        for (int c = 0; c < 3; ++c) photo.at(x, y, c) = (x / 3 + y / 3) % 2 == 0 ? 1.f : 0.f;
  const Error error =
      test::refused([&] { other.check(); }, ErrorCode::kInconsistent, "", "the model is of another scene");
  CHECK(error.remedy().find("near plane") == std::string::npos);
}

TEST_CASE("with --compat inria a model nearer than its near plane gets a hint that names what fits") {
  Capture small = shrunk(0.02);  // behind gsplat's near plane
  const Error error = test::refused([&] { small.check(); }, ErrorCode::kInconsistent, "", "--compat gsplat, or");
  CHECK(error.remedy().find("--compat auto") != std::string::npos);
  small.scene.compat = Compat::kGsplat;
  CHECK(small.check().median_fit_db > 60);                        // 73: the photos were rendered with 3DGS's footprints
  const Error smaller = thrown_by([] { shrunk(1e-3).check(); });  // before both near planes
  CHECK(smaller.remedy().find("--compat gsplat") == std::string::npos);
  CHECK(smaller.remedy().find("--compat auto") != std::string::npos);
}

TEST_CASE("a model partly between the near planes gives a warning if a nearer one matches the photos better") {
  Capture part = shrunk(0.04);
  const SceneCheckOptions anything{.min_fit_db = -100};
  const SceneCheck as_inria = part.check(anything);
  REQUIRE(as_inria.warnings.size() == 1);
  CHECK(as_inria.warnings[0].find("better with near planes scaled to this small world") != std::string::npos);
  CHECK(as_inria.world_unit == 1);
  part.scene.compat = Compat::kGsplat;
  CHECK(part.check(anything).warnings.empty());
  CHECK(tiny_capture().check(anything).warnings.empty());
  // As near, but culled by the renderer of the fit.
  part.scene.compat = Compat::kInria;
  for (std::size_t v = 0; v < part.photos.size(); ++v)
    part.photos[v] = render({}, part.cloud, part.scene.views[v].camera, {}, {}).colour;
  CHECK(part.check(anything).warnings.empty());
}

TEST_CASE("with --compat auto the renderer and near plane that match the photos best are used") {
  const auto checked = [](const Capture& capture) {
    return check_scene({}, test::Quiet(), {.min_fit_db = -100},
                       {&capture.cloud, capture.scene, capture.loaders(), true});
  };
  for (const double factor : {1e-3, 0.02, 0.04}) {
    CAPTURE(factor);
    Capture small = shrunk(factor);
    SceneCheck found = checked(small);
    CHECK(found.compat == Compat::kInria);
    CHECK(found.world_unit < 1);
    CHECK(found.median_fit_db > 60);
    CHECK((found.warnings.size() == 1 && found.warnings[0].find("used (--compat inria") != std::string::npos));
    if (factor < 0.01) continue;
    for (std::size_t v = 0; v < small.photos.size(); ++v)
      small.photos[v] = render({}, small.cloud, small.scene.views[v].camera, {.compat = Compat::kGsplat}, {}).colour;
    found = checked(small);
    CHECK(found.compat == Compat::kGsplat);
    CHECK(found.world_unit == 1);
  }
  CHECK(checked(tiny_capture()).compat == Compat::kInria);
  CHECK(checked(tiny_capture()).world_unit == 1);
}

TEST_CASE("without photos, near planes are scaled if they would remove a tenth of the model") {
  const auto checked = [](double factor) {
    Capture capture = shrunk(factor);
    for (SceneView& view : capture.scene.views) view.image_path.clear();
    return check_scene({}, test::Quiet(), {}, {&capture.cloud, capture.scene, capture.loaders(), true});
  };
  CHECK(checked(1).world_unit == 1);
  CHECK(checked(1).warnings.empty());
  const SceneCheck small = checked(1e-3);
  CHECK(small.world_unit < 0.01);
  CHECK((small.warnings.size() == 1 && small.warnings[0].find("scaled to this small world") != std::string::npos));
}

}  // namespace ngs
