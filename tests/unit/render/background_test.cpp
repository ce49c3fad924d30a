#include "ngs/render/background.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "support/joint_case.h"

namespace ngs {
namespace {

/// A ball, with or without a wall behind it, photographed over one colour per view.
struct Capture {
  GaussianCloud cloud;
  Scene scene;
  std::vector<ImageF> photos;

  /// pane < 1: transmittance of a sheet behind the ball that fills the image.
  Capture(bool wall, const std::vector<Vec3<float>>& behind, double pane = 1) {
    const auto known = test::joint_case(160, wall ? 120 : pane < 1 ? 1 : 0);
    cloud = known->truth;
    scene = known->scene;
    if (pane < 1) {
      cloud.logit_opacity[160] = float(std::log(1 / pane - 1));
      cloud.position[480] = cloud.position[481] = 0;
      cloud.log_scale[480] = cloud.log_scale[481] = 4;
    }
    for (std::size_t v = 0; v < scene.views.size(); ++v) {
      RenderRequest request{.label = {}, .background = behind[v % behind.size()]};
      photos.push_back(render({}, cloud, scene.views[v].camera, {}, request).colour);
    }
    std::uint64_t index = 0;  // quantised as in a file, with the error of a fitted model
    for (ImageF& photo : photos)
      for (float& c : photo.data)
        c = float(std::round(255 * (double(c) + 0.02 * (rng_uniform(5, RngStream::kTest, index++) - 0.5))) / 255);
  }
  BackgroundFinding find(int threads = 1) const {
    std::vector<std::size_t> all(scene.views.size());
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = v;
    return find_background(Exec{Device::kCpu, threads}, test::Quiet(),
                           {cloud, scene, [&](std::size_t v) { return photos[v]; }}, all);
  }
};

void check_near(const BackgroundFinding& found, Vec3<double> truth, double tolerance) {
  CAPTURE(found.gain_db);
  REQUIRE(found.colour.has_value());
  CHECK(std::abs(found.colour->x - truth.x) <= tolerance);
  CHECK(std::abs(found.colour->y - truth.y) <= tolerance);
  CHECK(std::abs(found.colour->z - truth.z) <= tolerance);
}

}  // namespace

TEST_CASE("the background is estimated from pixels that the model does not cover") {
  constexpr double kHalfLevel = 0.5 / 255 + 1e-6;
  check_near(Capture(false, {{1, 1, 1}}).find(), {1, 1, 1}, 2 * kHalfLevel);
  check_near(Capture(false, {{0.2f, 0.6f, 0.4f}}).find(), {0.2, 0.6, 0.4}, 2 * kHalfLevel);
}

TEST_CASE("the estimate does not depend on the number of threads") {
  const Capture capture(false, {{0.2f, 0.6f, 0.4f}});
  const BackgroundFinding one = capture.find(1), two = capture.find(2);
  CHECK(one.gain_db == two.gain_db);
  CHECK((one.error.x == two.error.x && one.fitted.z == two.fitted.z));
}

TEST_CASE("black is used if the background is black, and if no pixel shows it") {
  CHECK_FALSE(Capture(false, {{0, 0, 0}}).find().colour.has_value());
  CHECK_FALSE(Capture(true, {{0, 0, 0}}).find().colour.has_value());
  Capture covered(true, {{0, 0, 0}});
  for (std::size_t i = 160; i < covered.cloud.logit_opacity.size(); ++i) {  // sheets that fill every view
    covered.cloud.logit_opacity[i] = 2;  // opaque ones would stop compositing with T up to 0.01
    for (std::size_t a = 0; a < 3; ++a) covered.cloud.log_scale[3 * i + a] = a < 2 ? 3.f : -3.f;
    covered.cloud.position[3 * i] = covered.cloud.position[3 * i + 1] = 0;
  }
  const BackgroundFinding found = covered.find();
  CHECK(found.views == 0);
  CHECK_FALSE(found.colour.has_value());
}

TEST_CASE("a background seen only through a model that covers the image is reported, but not used") {
  const Capture pane(false, {{0.6f, 0, 0.4f}}, 0.06);  // mean T² of the image is 0.0036
  const BackgroundFinding found = pane.find();
  CHECK(found.shown < kMinShown);
  CHECK(found.gain_db > kBackgroundMarginDb);
  CHECK(std::abs(found.fitted.x - 0.6) < 0.02);
  CHECK_FALSE(found.colour.has_value());
  CHECK(Capture(false, {{0.6f, 0, 0.4f}}, 0.2).find().colour.has_value());
}

TEST_CASE("views with different backgrounds give no background") {
  const Capture capture(false, {{1, 1, 1}, {0.2f, 0.2f, 0.2f}, {0.6f, 0.6f, 0.6f}});
  const BackgroundFinding found = capture.find();
  CHECK(found.error.x > kMaxBackgroundError);
  CHECK_FALSE(found.colour.has_value());
}

TEST_CASE("a hole in the model does not outweigh the background") {
  Capture capture(false, {{0.1f, 0.1f, 0.1f}});  // a third of every photo shows bright surfaces that the model lacks
  for (ImageF& photo : capture.photos)
    for (int y = 0; y < photo.height_px / 3; ++y)
      for (int x = 0; x < photo.width_px; ++x)
        for (int c = 0; c < 3; ++c) photo.at(x, y, c) = 0.9f;
  check_near(capture.find(), {0.1, 0.1, 0.1}, 0.01);
}

TEST_CASE("a background is three numbers in [0, 1] or a name") {
  CHECK(parse_background("0.25,0,1").x == 0.25f);
  CHECK(parse_background("white").y == 1.f);
  CHECK(parse_background("black").z == 0.f);
  for (const char* text : {"", "1,2", "0,0,0,0", "0,0,2", "0,0,-1", "grey", "0,0,x", "0,0,nan"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse_background(text), Error);
  }
  const Vec3<float> third{1.f / 3, 0.1f, 1};
  const Vec3<float> back = parse_background(background_text(third));
  CHECK((back.x == third.x && back.y == third.y && back.z == third.z));
}

TEST_CASE("a given background overrides the scene's, with a warning if they differ clearly") {
  Monitor monitor;
  Scene scene;
  choose_background("", monitor, scene);
  CHECK_FALSE(scene.background.has_value());
  choose_background("white", monitor, scene);  // the scene has no background to contradict
  CHECK(background_of(scene).x == 1.f);
  choose_background("", monitor, scene);
  choose_background("0.95,1,1", monitor, scene);
  CHECK(monitor.warnings().empty());
  choose_background("black", monitor, scene);
  CHECK(monitor.warnings().size() == 1);
  CHECK(background_of(scene).x == 0.f);
}

TEST_CASE("the background that transparent photos were fitted over fits better than the other") {
  Capture capture(true, {{1, 1, 1}});
  Capture ball(false, {{1, 1, 1}});
  for (std::size_t i = 160; i < capture.cloud.logit_opacity.size(); ++i)  // a white wall, invisible over white
    for (std::size_t c = 0; c < 3; ++c) capture.cloud.sh_dc[3 * i + c] = 1.7724539f;
  const auto psnr = [&](double level, Capture& of) {
    of.scene.background = Vec3<double>{level, level, level};
    const auto laid_over = [&](std::size_t v) {
      RenderRequest request{.label = {}, .background = background_of(of.scene)};
      return render({}, ball.cloud, of.scene.views[v].camera, {}, request).colour;
    };
    return psnr_over_background({}, of.cloud, of.scene, {0, 2, 3}, laid_over);
  };
  CHECK(psnr(1, capture) > psnr(0, capture) + 3);
  for (const double level : {0.0, 0.3, 1.0}) CHECK(psnr(level, ball) > 100);  // the ball alone fits over any
}

}  // namespace ngs
