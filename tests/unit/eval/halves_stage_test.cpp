#include "ngs/eval/halves_stage.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/ops/image/metrics.h"

namespace ngs {
namespace {

using V = Vec3<double>;
constexpr int kSize = 64;

/// A grey disc of radius 12 in the middle, opaque.
struct Disc {
  ImageF colour{kSize, kSize, 3}, alpha{kSize, kSize, 1};
  Disc() {
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        if ((x - 32) * (x - 32) + (y - 32) * (y - 32) <= 144) paint(x, y);
  }
  void paint(int x, int y) {
    alpha.at(x, y) = 1.f;
    for (int c = 0; c < 3; ++c) colour.at(x, y, c) = 0.6f;
  }
  RenderedView view() const { return {kSize, kSize, colour, {}, alpha, {}}; }
};

/// A camera at (x, 0, -4) that looks along +z.
Camera camera_at(double x) {
  Camera camera{"v.png", kSize, kSize, 64, 64, 32, 32, {}, {}};
  camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  camera.translation = {-x, 0, 4};
  return camera;
}

/// A view of the plane z = 0, with a hole in columns 16 to 47 of every row.
HoleView plane_view(double x, float error) {
  HoleView view{camera_at(x), ImageF(kSize, kSize, 3, 0.5f + error), ImageF(kSize, kSize, 3, 0.5f),
                ImageF(kSize, kSize, 1, 4.f), std::vector<std::uint8_t>(kSize * kSize)};
  for (int y = 0; y < kSize; ++y)
    for (int c = 16; c < 48; ++c) view.hole[std::size_t(y * kSize + c)] = 1;
  return view;
}

}  // namespace

TEST_CASE("an object alone that equals its truth has full scores and no spikes or holes") {
  const Disc disc;
  const AloneScore score = score_alone({}, disc.view(), disc.colour, disc.alpha);
  CHECK(score.iou == 1);
  CHECK(score.biou == 1);
  CHECK(score.psnr_db == kEqualPsnrDb);
  CHECK(score.spikes_px == 0);
  CHECK(score.longest_spike_px == 0);
  CHECK(score.holes_px == 0);
}

TEST_CASE("a spike counts beyond the slack of 2 px, with its area and its length") {
  const Disc disc;
  Disc spiked;
  for (int x = 45; x <= 59; ++x) spiked.paint(x, 32);  // the disc ends at 44
  const AloneScore score = score_alone({}, spiked.view(), disc.colour, disc.alpha);
  CHECK(score.spikes_px == 13);
  CHECK(score.longest_spike_px == 15);
  CHECK(score.holes_px == 0);
  CHECK(score.iou < 1);
  CHECK(score.psnr_db < 40);  // the two pixels of the spike within the slack
}

TEST_CASE("a faint spike does not count, and neither does one over pixels that the truth touches") {
  const Disc disc;
  Disc faint, touched;
  for (int x = 45; x <= 59; ++x) {
    faint.alpha.at(x, 32) = 0.4f;
    touched.alpha.at(x, 32) = 0.1f;
  }
  CHECK(score_alone({}, faint.view(), disc.colour, disc.alpha).spikes_px == 0);
  Disc spiked;
  for (int x = 45; x <= 59; ++x) spiked.paint(x, 32);
  CHECK(score_alone({}, spiked.view(), touched.colour, touched.alpha).spikes_px == 0);
}

TEST_CASE("a hole counts where the truth is more than 2 px deep") {
  const Disc disc;
  Disc pierced, eroded;
  for (int y = 30; y < 35; ++y)
    for (int x = 30; x < 35; ++x) pierced.alpha.at(x, y) = 0.3f;
  CHECK(score_alone({}, pierced.view(), disc.colour, disc.alpha).holes_px == 25);
  for (int x = 0; x < kSize; ++x) {  // the disc begins at 20
    eroded.alpha.at(x, 20) = 0.f;
    eroded.alpha.at(x, 21) = 0.f;
  }
  const AloneScore contour = score_alone({}, eroded.view(), disc.colour, disc.alpha);
  CHECK(contour.holes_px <= 4);
  CHECK(contour.iou < 1);
}

TEST_CASE("a truth without the object and an opacity that is no number are errors") {
  const Disc disc;
  const ImageF nothing(kSize, kSize, 1);
  CHECK_THROWS_WITH_AS(score_alone({}, disc.view(), disc.colour, nothing), doctest::Contains("shows no object"), Error);
  RenderedView broken = disc.view();
  broken.alpha.at(3, 3) = NAN;
  CHECK_THROWS_WITH_AS(score_alone({}, broken, disc.colour, disc.alpha), doctest::Contains("opacity nan"), Error);
  broken = disc.view();
  broken.colour.at(32, 32, 1) = NAN;
  CHECK_THROWS_WITH_AS(score_alone({}, broken, disc.colour, disc.alpha), doctest::Contains("NaN"), Error);
}

TEST_CASE("the mean of scores is taken member by member") {
  const std::vector<AloneScore> scores = {{1, 0.5, 20, 4, 3, 2}, {0.5, 0.3, 30, 0, 1, 0}};
  const AloneScore mean = mean_of(scores);
  CHECK(mean.iou == 0.75);
  CHECK(mean.biou == 0.4);
  CHECK(mean.psnr_db == 25);
  CHECK(mean.spikes_px == 2);
  CHECK(mean.longest_spike_px == 2);
  CHECK(mean.holes_px == 1);
  CHECK(mean_of({}).iou == 0);
}

TEST_CASE("the point nearest to crossing optical axes is their crossing, and parallel axes have none") {
  Camera side = camera_at(0);  // at (5, 1, 2), looks along -x
  side.rotation = {{0, 0, 1, 0, 1, 0, -1, 0, 0}};
  side.translation = -1.0 * (side.rotation * V{5, 1, 2});
  Camera front = camera_at(3);
  front.translation = -1.0 * V{3, 1, -4};
  const std::vector<Camera> both = {front, side};
  const V focus = point_nearest_to_axes(both).value();
  CHECK(focus.x == doctest::Approx(3));
  CHECK(focus.y == doctest::Approx(1));
  CHECK(focus.z == doctest::Approx(2));
  CHECK(angle_to_nearest(focus, front, {both.data() + 1, 1}) == doctest::Approx(90));
  CHECK(angle_to_nearest(focus, front, both) == doctest::Approx(0));
  CHECK(angle_to_nearest(focus, front, {}) == doctest::Approx(180));
  const std::vector<Camera> parallel = {camera_at(0), camera_at(1)};
  CHECK_FALSE(point_nearest_to_axes(parallel));
  CHECK_FALSE(point_nearest_to_axes({}));
  CHECK(point_nearest_to_axes(parallel, {.weight = 1e-3, .ahead = 2}));
}

TEST_CASE("a hole is scored at its own pixels alone") {
  HoleView view = plane_view(0, 0.f);
  CHECK(score_hole({}, view).psnr_db == kEqualPsnrDb);
  CHECK(score_hole({}, view).ssim == doctest::Approx(1));
  for (int y = 0; y < kSize; ++y) view.rendered.at(2, y, 0) = 0.f;  // farther than an SSIM window from the hole
  CHECK(score_hole({}, view).psnr_db == kEqualPsnrDb);
  CHECK(score_hole({}, view).ssim == doctest::Approx(1));
  const HoleScore shifted = score_hole({}, plane_view(0, 0.1f));
  CHECK(shifted.psnr_db == doctest::Approx(20).epsilon(1e-4));
  for (int y = 0; y < kSize; y += 2)
    for (int x = 16; x < 48; ++x) view.rendered.at(x, y, 1) = 0.1f;
  CHECK(score_hole({}, view).ssim < 0.8);
}

TEST_CASE("flicker is zero for equal errors in all views, and half the difference of two views") {
  const std::vector<HoleView> equal = {plane_view(0, 0.f), plane_view(0.5, 0.f)};
  CHECK(flicker({}, equal).mean == 0);
  CHECK(flicker({}, equal).points > 100);
  const std::vector<HoleView> offset = {plane_view(0, 0.25f), plane_view(0.5, 0.25f)};
  CHECK(flicker({}, offset).mean == 0);
  const std::vector<HoleView> changing = {plane_view(0, 0.25f), plane_view(0.5, 0.f)};
  CHECK(flicker({}, changing).mean == doctest::Approx(0.125));
  CHECK(flicker({.threads = 3}, changing).mean == flicker({.threads = 1}, changing).mean);
}

TEST_CASE("flicker ignores points that one view alone shows, or that something hides") {
  const std::vector<HoleView> apart = {plane_view(0, 0.25f), plane_view(4, 0.f)};  // holes of 2 world units
  CHECK(flicker({}, apart).points == 0);
  CHECK(flicker({}, apart).mean == 0);
  std::vector<HoleView> hidden = {plane_view(0, 0.25f), plane_view(0.5, 0.f)};
  std::fill(hidden[1].depth.data.begin(), hidden[1].depth.data.end(), 3.f);  // another surface, nearer
  CHECK(flicker({}, hidden).points == 0);
}

TEST_CASE("a change counts outside of the hole and its margin only") {
  HoleView view = plane_view(0, 0.f);
  ImageF full = view.rendered;
  const int margin_px = 2;  // 0.02 of the diagonal of 90.5 px
  for (int y = 0; y < kSize; ++y) {
    full.at(20, y, 0) = 1.f;
    full.at(48 + margin_px - 1, y, 0) = 1.f;
  }
  const auto change = [&] { return outside_change({&view, 1}, {&full, 1}); };
  CHECK(change().most == 0);
  full.at(48 + margin_px, 5, 2) = 0.75f;
  CHECK(change().most == 0.25);
  CHECK(change().mean == doctest::Approx(0.25 / (3.0 * kSize * (kSize - 32 - 2 * margin_px))));
  std::fill(view.hole.begin(), view.hole.end(), 1);
  CHECK(change().mean == 0);
}

}  // namespace ngs
