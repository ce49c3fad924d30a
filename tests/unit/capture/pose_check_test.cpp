#include "ngs/capture/pose_check.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/render/background.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// The ball without its wall: most of the image shows the background.
struct OpenCapture {
  std::unique_ptr<test::JointCase> c = test::joint_case(160, 0);
  const Camera& camera = c->scene.views[0].camera;

  RenderedView over(Vec3<float> background, bool depth = false) const {
    RenderRequest request;
    request.background = background, request.depth = depth;
    return render({}, c->truth, camera, {}, request);
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
