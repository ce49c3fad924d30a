#include "ngs/ops/optim/pose_step.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/cameras.h"

namespace ngs {
namespace {

constexpr int kWidth = 80, kHeight = 64;

Camera camera() { return test::camera_along_z(kWidth, kHeight, 100); }

/// A textured plane at depth 5 before a camera that has moved.
RenderedView picture(const CameraMotion& motion, double gain = 1) {
  const Camera c = moved(camera(), motion);
  const ImageF alpha(kWidth, kHeight, 1, 1.f), depth(kWidth, kHeight, 1, 5.f);
  RenderedView view{kWidth, kHeight, ImageF(kWidth, kHeight, 3), {}, alpha, depth};
  const Mat3<double> back = transpose(c.rotation);
  const Vec3<double> eye = c.centre();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3<double> ray = back * Vec3<double>{(x + 0.5 - c.cx) / c.fx, (y + 0.5 - c.cy) / c.fy, 1};
      const double s = (5 - eye.z) / ray.z, u = 20 * (eye.x + s * ray.x), v = 20 * (eye.y + s * ray.y);
      for (int k = 0; k < 3; ++k)
        view.colour.at(x, y, k) =
            float(gain * (0.5 + 0.2 * std::sin(0.31 * u + 0.17 * v + k) + 0.2 * std::cos(0.13 * u - 0.37 * v)));
    }
  return view;
}

TEST_CASE("smoothed_for_pose is a 5x5 binomial filter with the border pixels repeated") {
  const double tap[5] = {1 / 16., 4 / 16., 6 / 16., 4 / 16., 1 / 16.};
  struct Size {
    int width_px, height_px, channels;
  };
  for (const Size& size : {Size{1, 1, 3}, Size{2, 5, 3}, Size{3, 1, 1}, Size{4, 4, 3}, Size{5, 3, 2}, Size{9, 7, 3}}) {
    const int w = size.width_px, h = size.height_px, channels = size.channels;
    CAPTURE(w);
    ImageF in(w, h, channels);
    for (std::size_t i = 0; i < in.data.size(); ++i) in.data[i] = float((i * i * 7 + 3 * i) % 101) / 100.f;
    const ImageF out = smoothed_for_pose(in);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int c = 0; c < channels; ++c) {
          double expected = 0;
          for (int k = 0; k < 25; ++k) {
            const int u = std::clamp(x + k % 5 - 2, 0, w - 1), v = std::clamp(y + k / 5 - 2, 0, h - 1);
            expected += tap[k % 5] * tap[k / 5] * double(in.at(u, v, c));
          }
          CHECK(std::abs(double(out.at(x, y, c)) - expected) < 1e-6);
        }
  }
}

TEST_CASE("pose_step of a small motion moves the image to that of the true camera") {
  for (const CameraMotion motion :
       {CameraMotion{{0, 0, 0.01}, {}}, CameraMotion{{}, {0, 0, 0.05}}, CameraMotion{{0.002, -0.003, 0.004}, {}}}) {
    const PoseStep step = pose_step(picture({}), smoothed_for_pose(picture(motion).colour), camera(), {});
    REQUIRE(step.determined);
    CAPTURE(step.motion.turn.z);
    // On a plane, a turn and a move across the line of sight look alike, so the test compares image positions.
    const Camera found = moved(camera(), step.motion), right = moved(camera(), motion);
    for (const double x : {-1.5, 1.5})
      for (const double y : {-1.2, 1.2}) {
        const auto projected = [&](const Camera& c) {
          const Vec3<double> p = c.rotation * Vec3<double>{x, y, 5} + c.translation;
          return Vec3<double>{c.fx * p.x / p.z, c.fy * p.y / p.z, 0};
        };
        const Vec3<double> a = projected(found), b = projected(right), still = projected(camera());
        CHECK(std::hypot(a.x - b.x, a.y - b.y) < 0.1 * std::hypot(b.x - still.x, b.y - still.y) + 0.02);
      }
  }
}

TEST_CASE("pose_step ignores an object that only the photo contains, and the photo's exposure") {
  ImageF photo = picture({}, 0.6).colour;
  for (int y = 10; y < 26; ++y)
    for (int x = 10; x < 26; ++x)
      for (int k = 0; k < 3; ++k) photo.at(x, y, k) = 1.f;  // a twentieth of the image
  const PoseStep step = pose_step(picture({}), smoothed_for_pose(photo), camera(), {});
  REQUIRE(step.determined);
  CHECK(step.flow_px < 0.1);
}

TEST_CASE("pose_step of one pixel in four finds nearly the motion of all pixels") {
  const CameraMotion motion{{0.002, -0.003, 0.004}, {}};
  const ImageF photo = smoothed_for_pose(picture(motion).colour);
  const PoseStep all = pose_step(picture({}), photo, camera(), {}),
                 some = pose_step(picture({}), photo, camera(), {}, 2);
  REQUIRE(some.determined);
  CHECK(std::abs(some.flow_px - all.flow_px) < 0.05 * all.flow_px);
  CHECK(some.error != all.error);
}

TEST_CASE("pose_step reduces an earlier motion that the photo does not determine") {
  const CameraMotion far{{0.5, 0, 0}, {0, 2.5, 0}};  // turn and move cancel on the plane
  const PoseStep step = pose_step(picture({}), smoothed_for_pose(picture({}).colour), camera(), far);
  REQUIRE(step.determined);
  CHECK(step.motion.turn.x < 0);
  CHECK(step.motion.move.y < 0);
}

TEST_CASE("pose_step is undetermined without texture, without a model in view and for a too small image") {
  RenderedView flat = picture({});
  std::fill(flat.colour.data.begin(), flat.colour.data.end(), 0.5f);
  CHECK(!pose_step(flat, flat.colour, camera(), {}).determined);
  RenderedView nothing = picture({});
  std::fill(nothing.alpha.data.begin(), nothing.alpha.data.end(), 0.f);
  std::fill(nothing.depth.data.begin(), nothing.depth.data.end(), 0.f);
  CHECK(!pose_step(nothing, nothing.colour, camera(), {}).determined);
  const RenderedView small{6, 6, ImageF(6, 6, 3, 0.2f), {}, ImageF(6, 6, 1, 1.f), ImageF(6, 6, 1, 2.f)};
  CHECK(!pose_step(small, small.colour, camera(), {}).determined);
}

}  // namespace
}  // namespace ngs
