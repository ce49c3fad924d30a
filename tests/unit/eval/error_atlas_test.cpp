#include <doctest/doctest.h>

#include <set>

#include "ngs/eval/eval_stage.h"
#include "support/changed_labels.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// The ball in front of its wall in view 1 with perfect labels, and a prediction that is wrong everywhere, so that
/// every pixel gets a cause.
struct AtlasCase {
  std::unique_ptr<test::JointCase> base = test::joint_case();
  GaussianCloud cloud = base->truth;
  LabelColumns labels;
  std::vector<std::uint8_t> truth, predicted, input;

  AtlasCase() {
    const auto n = std::size_t(cloud.size());
    labels.label = base->is_ball;
    labels.views.assign(n, 4.f);
    labels.boundary.assign(n, 0.f);
    for (const float t : base->masks[1].target[0]) {
      truth.push_back(t > 0.5f);
      predicted.push_back(t <= 0.5f);
    }
  }
  ErrorAtlas run(int threads = 1) const {
    const Camera& c = base->scene.views[1].camera;
    const auto plane = [&](const std::vector<std::uint8_t>& m) {
      return MaskPlane{m.empty() ? nullptr : m.data(), c.width_px, c.height_px};
    };
    return error_atlas({.threads = threads}, {cloud, labels, c, {}, plane(predicted), plane(truth), plane(input)});
  }
  /// Cause of the pixel at the ball's centre.
  ErrorCause at_ball() const {
    const Camera& c = base->scene.views[1].camera;
    const Vec3<double> t = c.rotation * Vec3<double>{0, 0, 4} + c.translation;
    const auto x = std::size_t(c.fx * t.x / t.z + c.cx), y = std::size_t(c.fy * t.y / t.z + c.cy);
    return run().cause[y * std::size_t(c.width_px) + x];
  }
};

}  // namespace

TEST_CASE("correct pixels have no cause, and every wrong pixel has exactly one") {
  AtlasCase c;
  const ErrorAtlas all = c.run();
  CHECK(all.wrong() == 48 * 40);
  CHECK(all.pixels[0] == 0);
  CHECK(all.cause == c.run(3).cause);
  c.predicted = c.truth;
  CHECK(c.run().wrong() == 0);
  CHECK(c.run().pixels[0] == 48 * 40);
}

TEST_CASE("each cause is distinguished from the others") {
  AtlasCase c;
  CHECK(c.at_ball() == ErrorCause::kLabel);  // ball in labels and render, not in the prediction
  SUBCASE("an uncertain edge") {
    test::change(c.labels.label, [](float l) { return l > 0.5f ? 0.6f : 0.f; });
    CHECK(c.at_ball() == ErrorCause::kSoftEdge);
  }
  SUBCASE("straddlers") {
    c.labels.boundary.assign(c.labels.boundary.size(), 1.f);
    CHECK(c.at_ball() == ErrorCause::kStraddler);
  }
  SUBCASE("the input mask has the same error, or not") {
    c.input = c.predicted;
    CHECK(c.at_ball() == ErrorCause::kInputMask);
    c.input = c.truth;
    CHECK(c.at_ball() == ErrorCause::kLabel);
  }
  SUBCASE("Gaussians visible in two views") {
    c.labels.views.assign(c.labels.views.size(), 2.f);
    CHECK(c.at_ball() == ErrorCause::kUnseen);
  }
  SUBCASE("a transparent splat") {
    for (float& o : c.cloud.logit_opacity) o = -4.f;
    CHECK(c.at_ball() == ErrorCause::kReach);
  }
  SUBCASE("something in front of the object") {
    const Vec3<double> eye = c.base->scene.views[1].camera.centre(), p = eye + 0.4 * (Vec3<double>{0, 0, 4} - eye);
    const auto i = std::size_t(c.cloud.size()) - 1;  // a Gaussian of the wall
    c.cloud.position[3 * i] = float(p.x);
    c.cloud.position[3 * i + 1] = float(p.y);
    c.cloud.position[3 * i + 2] = float(p.z);
    c.cloud.logit_opacity[i] = 6;
    CHECK(c.at_ball() == ErrorCause::kFloater);
  }
}

TEST_CASE("causes have distinct names and distinct colours") {
  std::set<std::string_view> names;
  std::set<std::array<std::uint8_t, 3>> colours;
  for (const ErrorCauseName& c : kErrorCauseNames) {
    names.insert(c.name);
    colours.insert(c.rgb);
  }
  CHECK(names.size() == kErrorCauses);
  CHECK(colours.size() == kErrorCauses);
}

}  // namespace ngs
