#include "ngs/interactive/ball_cut.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "ngs/core/error.h"
#include "ngs/interactive/viewpoint.h"
#include "ngs/math/sh.h"
#include "ngs/scene/mask_threshold.h"
#include "support/quiet.h"
#include "support/splat_shapes.h"
#include "support/stroke_rule.h"

namespace ngs {
namespace {

/// A floor with a box on it, of which one side is as dark as the floor, and a distant box, or a pedestal of the
/// box's colour in the void with the box on it and another box in the air; eight cameras around.
struct Room {
  GaussianCloud cloud;
  std::vector<std::uint8_t> is_object;
  Scene scene;
  SplatOptions splat;
  static constexpr orbit::Ball kBall{{0, 0, 0.3}, 1};

  explicit Room(bool on_pedestal = false) {
    if (on_pedestal) {
      pedestal();
      box({0, 0}, true);
      box({0, 0}, false, 1.2);
    } else {
      for (double x = -3; x <= 3; x += 0.08)
        for (double y = -3; y <= 3; y += 0.08) add({x, y, 0}, {0.06, 0.06, 0.002}, {0.25, 0.2, 0.15}, false);
      box({0, 0}, true);
      box({2.2, 0}, false);
    }
    classify(cloud);
    for (int k = 0; k < 8; ++k) {
      const double turn = std::numbers::pi / 4 * k;
      live::Viewpoint viewpoint{{3 * std::cos(turn), 3 * std::sin(turn), 1.1}, {0, 0, 0.3}, {0, 0, 1}, 40, 240, 180};
      SceneView view{live::camera_of(viewpoint), {}, {}, Split::kTrain};
      view.camera.name = "v" + std::to_string(k) + ".png";
      scene.views.push_back(view);
    }
    scene.objects.push_back({});
  }

  void add(Vec3<double> at, Vec3<double> scale, Vec3<double> rgb, bool object) {
    test::add_gaussian(cloud, at, scale, (1 / kShC0) * (rgb - Vec3<double>{0.5, 0.5, 0.5}), 4);
    is_object.push_back(object);
  }

  void pedestal() {
    for (double a = -0.5; a <= 0.51; a += 0.05)
      for (double b = -0.5; b <= 0.51; b += 0.05) {
        const Vec3<double> pale{0.8, 0.7, 0.6};
        add({a, b, 0}, {0.04, 0.04, 0.002}, pale, false);
        for (const double side : {-0.5, 0.5}) {
          add({side, a, b - 0.5}, {0.002, 0.04, 0.04}, pale, false);
          add({a, side, b - 0.5}, {0.04, 0.002, 0.04}, pale, false);
        }
      }
  }

  void box(std::array<double, 2> at, bool object, double height = 0) {
    for (double a = -0.3; a <= 0.31; a += 0.06)
      for (double b = -0.3; b <= 0.31; b += 0.06) {
        const auto put = [&](double x, double y, double z, Vec3<double> rgb) {
          add({at[0] + x, at[1] + y, z + height}, {0.04, 0.04, 0.04}, rgb, object);
        };
        const Vec3<double> pale{0.8, 0.7, 0.6}, dark{0.28, 0.22, 0.17};
        put(a, b, 0.66, pale);
        put(a, -0.3, 0.36 + b, pale);
        put(a, 0.3, 0.36 + b, pale);
        put(0.3, a, 0.36 + b, pale);
        put(-0.3, a, 0.36 + b, dark);
      }
  }

  /// A stroke between the projections of two points of the model.
  PromptStroke stroke(std::size_t view, bool object, Vec3<double> from, Vec3<double> to) const {
    PromptStroke out{object, 3, {}};
    const Camera& camera = scene.views[view].camera;
    for (const Vec3<double>& point : {from, to}) {
      const Vec3<double> at = camera.rotation * point + camera.translation;
      out.points.push_back({camera.fx * at.x / at.z + camera.cx, camera.fy * at.y / at.z + camera.cy});
    }
    return out;
  }

  /// The exact mask of the object in the camera.
  PixelMask truth(std::size_t view) const {
    const std::vector<float> channel(is_object.begin(), is_object.end());
    RenderRequest request{.label = {channel.data(), cloud.size(), 1}};
    const RenderedView seen = render({}, cloud, scene.views[view].camera, splat, request);
    PixelMask mask;
    for (const float share : seen.label.data) mask.push_back(label_is_foreground(share));
    return mask;
  }

  std::vector<HandPrompt> by_rule(std::size_t view) const {
    const Camera& camera = scene.views[view].camera;
    return {test::strokes_of_truth(truth(view), camera.width_px, camera.height_px, camera.name)};
  }

  live::BallCut cut(const std::map<std::size_t, std::vector<HandPrompt>>& marks, int threads = 2) const {
    return live::cut_in_ball({.threads = threads}, test::Quiet(), {cloud, kBall, scene, splat, marks});
  }

  double iou(const live::BallCut& cut) const {
    double both = 0, either = 0;
    for (std::size_t i = 0; i < is_object.size(); ++i) {
      const bool found = cut.labels.label[i] > 0;
      both += found && is_object[i];
      either += found || is_object[i];
    }
    return both / either;
  }
};

TEST_CASE("strokes around an object in two views separate it from its floor, even a side of the floor's colour") {
  const Room room;
  const live::BallCut cut = room.cut({{0, room.by_rule(0)}, {2, room.by_rule(2)}});
  CHECK(room.iou(cut) > 0.88);  // .8975: colours are ambiguous at the dark foot
  std::int64_t of_floor = 0, dark = 0, dark_found = 0;
  for (std::size_t i = 0; i < room.is_object.size(); ++i) {
    of_floor += cut.labels.label[i] > 0 && room.cloud.position[3 * i + 2] == 0;
    const bool is_dark = room.is_object[i] && room.cloud.position[3 * i] == -0.3f;
    dark += is_dark;
    dark_found += is_dark && cut.labels.label[i] > 0;
  }
  CHECK(of_floor <= 3);
  CHECK(dark_found > 0.9 * double(dark));
  for (const SpreadView& view : cut.views) CHECK(view.source != MaskSource::kUnseen);
}

TEST_CASE("Gaussians outside the ball are background and are not rendered") {
  const Room room;
  const live::BallCut cut = room.cut({{0, room.by_rule(0)}, {2, room.by_rule(2)}});
  CHECK(cut.in_ball < room.cloud.size() / 2);
  for (std::size_t i = 0; i < room.is_object.size(); ++i)
    if (room.cloud.position[3 * i] > 1.2f) {
      CHECK(cut.labels.label[i] == 0);
      CHECK(cut.labels.views[i] == 1);
    }
}

TEST_CASE("without surrounding strokes masks are spread from view to view") {
  const Room room;
  HandPrompt hand = room.by_rule(0)[0];
  hand.strokes.resize(1);  // only the one on the object
  hand.strokes.push_back({false, 3, {{20, 150}, {220, 150}}});
  const live::BallCut cut = room.cut({{0, {hand}}});
  CHECK(room.iou(cut) > 0.5);
  CHECK(cut.views[0].source == MaskSource::kReference);
}

TEST_CASE("strokes on an object and its pedestal of the same colour cut along the plane between them") {
  const Room room(true);
  HandPrompt hand{"v0.png", 240, 180, {}, {}, {}, {}};
  hand.strokes = {room.stroke(0, true, {0.3, 0, 0.6}, {0.3, 0, 0.15}),
                  room.stroke(0, false, {0.5, -0.4, -0.4}, {0.5, 0.4, -0.4})};
  const live::BallCut cut = room.cut({{0, {hand}}});
  CHECK(cut.is_expected);
  CHECK(room.iou(cut) > 0.88);
  std::int64_t below = 0, in_the_air = 0;
  for (std::size_t i = 0; i < room.is_object.size(); ++i) {
    below += cut.labels.label[i] > 0 && room.cloud.position[3 * i + 2] < -0.01f;
    in_the_air += cut.labels.label[i] > 0 && room.cloud.position[3 * i + 2] > 1;
  }
  CHECK(below == 0);
  CHECK(in_the_air == 0);
}

TEST_CASE("a cut in a ball is the same for any number of threads") {
  const Room room;
  const std::map<std::size_t, std::vector<HandPrompt>> marks{{0, room.by_rule(0)}, {2, room.by_rule(2)}};
  const live::BallCut one = room.cut(marks, 1), three = room.cut(marks, 3);
  CHECK(one.labels.label == three.labels.label);
  CHECK(one.labels.prob == three.labels.prob);
  for (std::size_t v = 0; v < one.views.size(); ++v) CHECK(one.views[v].mask == three.views[v].mask);
}

TEST_CASE("a ball without Gaussians is kNothingFound") {
  const Room room;
  const live::BallCutInput input{room.cloud, {{50, 0, 0}, 1}, room.scene, room.splat, {{0, room.by_rule(0)}}};
  CHECK_THROWS_AS(live::cut_in_ball({}, test::Quiet(), input), Error);
}

}  // namespace
}  // namespace ngs
