#include "ngs/cut/passes/exposure/exposure.h"

#include <doctest/doctest.h>

#include "support/joint_case.h"

namespace ngs {
namespace {

/// Photos are renderings of the model, multiplied by the gains.
struct Exposed {
  std::unique_ptr<test::JointCase> base = test::joint_case();

  explicit Exposed(const std::vector<ExposureGain>& gains) {
    for (std::size_t v = 0; v < 4; ++v) {
      base->photos[v] = render({}, base->model, base->scene.views[v].camera, {}, {}).colour;
      for (std::size_t i = 0; i < base->photos[v].data.size(); ++i) base->photos[v].data[i] *= gains[v][i % 3];
    }
  }
  std::vector<ViewExposure> found() const { return view_exposures({}, base->input(), {0, 1, 2, 3}); }
};

const ExposureGain kSame{1, 1, 1};

}  // namespace

TEST_CASE("gains of views and channels are estimated relative to the median over the views") {
  const Exposed c({kSame, {0.8f, 0.85f, 0.9f}, kSame, {1.1f, 1.f, 1.05f}});
  const auto found = c.found();
  REQUIRE(found.size() == 4);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(found[0].gain[k] == doctest::Approx(1).epsilon(1e-5));
    CHECK(found[1].gain[k] == doctest::Approx(0.8 + 0.05 * double(k)).epsilon(1e-5));
  }
  CHECK(found[3].gain[0] == doctest::Approx(1.1).epsilon(1e-5));
  CHECK(exposure_spread_percent(found) == doctest::Approx(25).epsilon(1e-3));
  const ImageF level = equalised_photo(found, 1, c.base->photos[1]);
  const ImageF want = render({}, c.base->model, c.base->scene.views[1].camera, {}, {}).colour;
  for (std::size_t i = 0; i < want.data.size(); ++i)
    CHECK(level.data[i] == doctest::Approx(want.data[i]).epsilon(1e-4));
}

TEST_CASE("an exposure shared by all photos is the model's own, and all gains are 1") {
  const Exposed c({{0.7f, 0.7f, 0.7f}, {0.7f, 0.7f, 0.7f}, {0.7f, 0.7f, 0.7f}, {0.7f, 0.7f, 0.7f}});
  CHECK(exposure_spread_percent(c.found()) < 1e-3);
}

TEST_CASE("a shadow over a third of a photo does not change the gain, although the mean darkens") {
  Exposed c({kSame, kSame, kSame, kSame});
  ImageF& photo = c.base->photos[2];
  double before = 0, after = 0;
  for (std::size_t i = 0; i < photo.data.size(); ++i) {
    before += double(photo.data[i]);
    if (i < photo.data.size() / 3) photo.data[i] *= 0.6f;
    after += double(photo.data[i]);
  }
  CHECK(after < 0.9 * before);
  CHECK(exposure_spread_percent(c.found()) < 1e-3);
}

TEST_CASE("clipped, dark or too few pixels give a gain of 1, and a view without a photo has no entry") {
  Exposed c({kSame, kSame, kSame, kSame});
  std::fill(c.base->photos[0].data.begin(), c.base->photos[0].data.end(), 1.f);    // clipped
  std::fill(c.base->photos[1].data.begin(), c.base->photos[1].data.end(), 0.05f);  // dark
  c.base->photos[2] = {};
  const auto found = c.found();
  REQUIRE(found.size() == 3);
  for (const ViewExposure& e : found) {
    CHECK(e.view != 2);
    for (const float g : e.gain) CHECK(g == 1.f);
  }
  CHECK(view_exposures({}, c.base->input(), {}).empty());
  CHECK(exposure_spread_percent({}) == 0);
  CHECK(equalised_photo(found, 2, {}).empty());
}

}  // namespace ngs
