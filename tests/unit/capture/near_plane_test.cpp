// Near planes of small worlds, and the renderer that matches the photos.
#include <doctest/doctest.h>

#include "support/checked_capture.h"

namespace ngs {
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
  const Error error = thrown_by([&] { other.check(); });
  CHECK(error.code() == ErrorCode::kInconsistent);
  CHECK(error.remedy().find("near plane") == std::string::npos);
  CHECK(error.remedy().find("the model is of another scene") != std::string::npos);
}

TEST_CASE("with --compat inria a model nearer than its near plane gets a hint that names what fits") {
  Capture small = shrunk(0.02);  // behind gsplat's near plane
  const Error error = thrown_by([&] { small.check(); });
  CHECK(error.code() == ErrorCode::kInconsistent);
  CHECK(error.remedy().find("--compat gsplat, or") != std::string::npos);
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
    Monitor monitor;
    return check_scene({}, monitor, {.min_fit_db = -100}, {&capture.cloud, capture.scene, capture.loaders(), true});
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
    Monitor monitor;
    return check_scene({}, monitor, {}, {&capture.cloud, capture.scene, capture.loaders(), true});
  };
  CHECK(checked(1).world_unit == 1);
  CHECK(checked(1).warnings.empty());
  const SceneCheck small = checked(1e-3);
  CHECK(small.world_unit < 0.01);
  CHECK((small.warnings.size() == 1 && small.warnings[0].find("scaled to this small world") != std::string::npos));
}

}  // namespace ngs
