#include "ngs/stages/view_shift.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/joint_case.h"

namespace ngs {
namespace {

struct Measured {
  std::unique_ptr<test::JointCase> c = test::joint_case();
  std::vector<ViewShift> shifts;
  /// View 1's camera is wrong by (dx, dy); the photos are those of the true cameras.
  Measured(double dx, double dy, int threads = 1) {
    for (SceneView& view : c->scene.views) view.image_path = "photo";
    c->scene.views[1].camera.cx -= dx, c->scene.views[1].camera.cy -= dy;
    Monitor monitor;
    Exec exec;
    exec.threads = threads;
    shifts =
        measure_view_shifts(exec, monitor, c->truth, c->scene, [&](std::size_t v) { return c->photos[v]; });
  }
};

TEST_CASE("a camera that is off by pixels is brought back, the others stay") {
  Measured m(1.2, -0.8);
  REQUIRE(m.shifts.size() == 4);
  for (const ViewShift& s : m.shifts) CHECK(s.applied == (s.view == 1));
  CHECK(std::abs(m.shifts[1].dx_px - 1.2) < 0.05);
  CHECK(std::abs(m.shifts[1].dy_px + 0.8) < 0.05);
  CHECK(m.shifts[1].error_after < 0.1 * m.shifts[1].error_before);
  apply_view_shifts(m.shifts, m.c->scene);
  CHECK(std::abs(m.c->scene.views[1].camera.cx - 24.5) < 0.05);
  CHECK(m.c->scene.views[0].camera.cx == 24.5);
}

TEST_CASE("view shifts: none for exact cameras, none without photos, the same for any number of threads") {
  for (const ViewShift& s : Measured(0, 0).shifts) CHECK(!s.applied);
  const Measured one(0.9, 0.3, 1), three(0.9, 0.3, 3);
  for (std::size_t v = 0; v < 4; ++v) {
    CHECK(one.shifts[v].dx_px == three.shifts[v].dx_px);
    CHECK(one.shifts[v].applied == three.shifts[v].applied);
  }
  auto c = test::joint_case();  // no image_path: no photo
  Monitor monitor;
  CHECK(measure_view_shifts({}, monitor, c->truth, c->scene, [](std::size_t) { return ImageF(); }).empty());
  for (SceneView& view : c->scene.views) view.image_path = "photo";
  CHECK_THROWS_AS(measure_view_shifts(
                      {}, monitor, c->truth, c->scene,
                      [](std::size_t) -> ImageF { throw Error(ErrorCode::kBadInput, "photo: broken", ""); }),
                  Error);
}

}  // namespace
}  // namespace ngs
