#include "ngs/capture/view_align.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/capture/pose_check.h"
#include "ngs/render/background.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

struct Measured {
  std::unique_ptr<test::JointCase> c = test::joint_case();
  std::vector<ViewAlignment> views;
  Camera right;  // view 1's
  /// View 1's camera is wrong by the inverse of `motion`; the photos are those of the true cameras.
  explicit Measured(const CameraMotion& motion, int threads = 1, float gain = 1.f) {
    for (SceneView& view : c->scene.views) view.image_path = "photo";
    right = c->scene.views[1].camera;
    c->scene.views[1].camera = moved(right, {-1.0 * motion.turn, -1.0 * motion.move});
    for (float& x : c->photos[1].data) x = gain * x + 0.2f * (1.f - gain);
    const Exec exec{.threads = threads};
    views = measure_alignment(exec, test::Quiet(), {c->truth, c->scene, [&](std::size_t v) { return c->photos[v]; }},
                              {1, 2});
  }
  /// Largest distance between the projections of the object's points by the two cameras, px.
  double error_px(const Camera& camera) const {
    double worst = 0;
    for (std::int64_t i = 0; i < c->truth.size(); ++i) {
      const float* p = &c->truth.position[std::size_t(3 * i)];
      const auto seen = [&](const Camera& from) {
        const Vec3<double> x = from.rotation * Vec3<double>{p[0], p[1], p[2]} + from.translation;
        return std::pair{from.fx * x.x / x.z, from.fy * x.y / x.z};
      };
      const auto [u, v] = seen(right);
      const auto [a, b] = seen(camera);
      worst = std::max(worst, std::hypot(u - a, v - b));
    }
    return worst;
  }
};

TEST_CASE("a rotated and moved camera is corrected, the others stay") {
  Measured m({{0.01, -0.015, 0.03}, {0.02, 0.01, -0.05}});
  REQUIRE(m.views.size() == 4);
  const double before = m.error_px(m.c->scene.views[1].camera);
  for (const ViewAlignment& a : m.views) CHECK(a.applied == (a.view == 1));
  CHECK(m.views[1].error_after < 0.1 * m.views[1].error_before);
  apply_alignment(m.views, m.c->scene);
  const double after = m.error_px(m.c->scene.views[1].camera);
  MESSAGE("largest error " << before << " -> " << after << " px");
  CHECK(before > 1);
  CHECK(after < 0.19);  // measured 0.15
}

TEST_CASE("the background is measured at the aligned camera") {
  Measured m({{0.01, -0.015, 0.03}, {0.02, 0.01, -0.05}});
  const Camera before = m.c->scene.views[1].camera;
  apply_alignment(m.views, m.c->scene);
  CHECK(!m.views[0].background);  // not in background_views
  const auto from_render = [&](std::size_t v, const Camera& camera) {
    return measure_background(render({}, m.c->truth, camera, {}, {}), m.c->photos[v]);
  };
  for (const std::size_t v : {std::size_t(1), std::size_t(2)}) {  // moved, and not moved
    CAPTURE(v);
    REQUIRE(m.views[v].background);
    const BackgroundMeasurement told = *m.views[v].background, own = from_render(v, m.c->scene.views[v].camera);
    CHECK(told.open);
    CHECK(told.colour == own.colour);
    CHECK(told.residual == own.residual);
    CHECK(told.residual2 == own.residual2);
    CHECK(told.open2 == own.open2);
  }
  CHECK(m.views[1].background->residual2[0] < 0.5 * from_render(1, before).residual2[0]);
}

TEST_CASE("a darker photo moves no camera, and hides no motion") {
  for (const ViewAlignment& a : Measured({}, 1, 0.7f).views) CHECK(!a.applied);
  Measured m({{0.01, 0.02, 0}, {0, 0, 0}}, 1, 0.7f);
  apply_alignment(m.views, m.c->scene);
  CHECK(m.error_px(m.c->scene.views[1].camera) < 0.19);  // measured 0.12
}

TEST_CASE("alignment does not depend on the number of threads; exact views are not moved") {
  for (const ViewAlignment& a : Measured({}).views) CHECK(!a.applied);
  const CameraMotion motion{{0.02, 0.01, 0}, {0.01, 0, 0}};
  const Measured one(motion, 1), three(motion, 3);
  for (std::size_t v = 0; v < 4; ++v) {
    CHECK(one.views[v].flow_px == three.views[v].flow_px);
    CHECK(one.views[v].applied == three.views[v].applied);
  }
}

TEST_CASE("views without photos are not aligned; a photo that cannot be read is an error") {
  const auto c = test::joint_case();  // no image_path: no photo
  const auto broken = [](std::size_t) -> ImageF { throw Error(ErrorCode::kBadInput, "photo: broken", ""); };
  CHECK(measure_alignment({}, test::Quiet(), {c->truth, c->scene, broken}).empty());
  for (SceneView& view : c->scene.views) view.image_path = "photo";
  CHECK_THROWS_AS(measure_alignment({}, test::Quiet(), {c->truth, c->scene, broken}), Error);
}

TEST_CASE("all views are aligned if one of the first kAlignedFirst moves") {
  const auto aligned = [](std::size_t turned) {
    auto c = test::joint_case();
    std::vector<SceneView>& views = c->scene.views;
    for (SceneView& view : views) view.image_path = "photo";
    while (views.size() < 30) views.push_back(views[views.size() % 4]);
    views[turned].camera = moved(views[turned].camera, {{0.01, -0.015, 0.03}, {0.02, 0.01, -0.05}});
    return measure_alignment({}, test::Quiet(), {c->truth, c->scene, [&](std::size_t v) { return c->photos[v % 4]; }},
                             {4});
  };
  const auto has = [](const std::vector<ViewAlignment>& some, std::size_t view) {
    return std::ranges::find(some, view, &ViewAlignment::view) != some.end();
  };
  const std::vector<ViewAlignment> all = aligned(5), few = aligned(9);
  CHECK(all.size() == 30);
  CHECK(std::ranges::count_if(all, &ViewAlignment::applied) == 1);
  CHECK(has(few, 4));  // in background_views, and not among the first
  CHECK_FALSE(has(few, 9));
  CHECK(few.size() == kAlignedFirst + 1);
}

/// The ball without its wall: most of the image shows the background.
struct OpenCapture {
  std::unique_ptr<test::JointCase> c = test::joint_case(160, 0);
  const Camera& camera = c->scene.views[0].camera;

  RenderedView over(Vec3<float> background, bool depth = false) const {
    return render({}, c->truth, camera, {}, {.depth = depth, .label = {}, .background = background});
  }
};

}  // namespace

TEST_CASE("a view rendered over black and composited onto a background equals a render over it") {
  const OpenCapture capture;
  const Vec3<float> behind{0.2f, 1, 0.6f};
  const RenderedView laid = over_background(capture.over({}, true), behind), drawn = capture.over(behind, true);
  double largest = 0, brightened = 0;
  const RenderedView black = capture.over({});
  for (std::size_t i = 0; i < drawn.colour.data.size(); ++i) {
    largest = std::max(largest, std::abs(double(laid.colour.data[i]) - double(drawn.colour.data[i])));
    brightened = std::max(brightened, double(laid.colour.data[i]) - double(black.colour.data[i]));
  }
  CHECK(largest < 3e-7);  // rounding: the transmittance is one minus a float
  CHECK(brightened == doctest::Approx(1));
  CHECK(laid.alpha.data == drawn.alpha.data);
  CHECK(laid.depth.data == drawn.depth.data);
}

TEST_CASE("match_photo equals match_rendered of the same view, with the fitted background") {
  const OpenCapture capture;
  const Vec3<float> behind{0.2f, 0.9f, 0.6f};
  const ImageF photo = capture.over(behind).colour;
  const PhotoMatch match = match_rendered(capture.over({}, true), photo);
  CHECK(match.psnr_db > 100);
  CHECK(match.background.x == doctest::Approx(0.2));
  CHECK(match.background.y == doctest::Approx(0.9));
  CHECK(match.background.z == doctest::Approx(0.6));
  const PhotoMatch own = match_photo({}, capture.c->truth, {capture.camera, photo}, {});
  CHECK(own.psnr_db == match.psnr_db);
  CHECK(own.covered == match.covered);
  CHECK_THROWS(match_rendered(capture.over({}), ImageF(7, 7, 3)));
}

}  // namespace ngs
