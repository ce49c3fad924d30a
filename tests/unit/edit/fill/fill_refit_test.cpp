#include "ngs/edit/fill/fill_refit.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/math/sh.h"
#include "ngs/orbit/rigs.h"

namespace ngs {
namespace {

constexpr int kSide_px = 48;

/// A grey floor with a square hole, and pictures in which it has no hole but a red square.
struct RefitCase {
  Scene scene;
  GaussianCloud cloud;
  std::vector<std::size_t> views;
  std::vector<ImageF> pictures;
  std::vector<PixelMask> holes;

  explicit RefitCase(int cameras) {
    GaussianCloud whole;
    for (const bool is_hole : {false, true})
      for (int y = -10; y <= 10; ++y)
        for (int x = -10; x <= 10; ++x) {
          if ((std::max(std::abs(x), std::abs(y)) <= 4) != is_hole) continue;
          add(whole, x, y, is_hole);
          if (!is_hole) add(cloud, x, y, false);
        }
    for (int k = 0; k < cameras; ++k) look(whole, k);
  }
  static void add(GaussianCloud& to, int x, int y, bool red) {
    const auto i = std::size_t(to.size());
    to.resize(to.size() + 1, 0);
    to.position[3 * i] = 0.1f * float(x);
    to.position[3 * i + 1] = 0.1f * float(y);
    for (std::size_t a = 0; a < 3; ++a) {
      to.log_scale[3 * i + a] = std::log(a == 2 ? 0.005f : 0.07f);
      to.sh_dc[3 * i + a] = dc_of_colour(red ? (a == 0 ? 0.9f : 0.1f) : 0.5f);
    }
    to.rotation[4 * i] = 1;
    to.logit_opacity[i] = 4;
    to.usable[i] = 1;
  }
  void look(const GaussianCloud& whole, int k) {
    SceneView view;
    const orbit::Vec eye{1.6 * std::cos(2.0 * k), 1.6 * std::sin(2.0 * k), 1.4};
    view.camera = orbit::camera_at({eye, {0, 0, 0}}, {kSide_px, kSide_px, 50}, {}, whole.origin);
    view.image_path = "given";
    const RenderedView full = render({}, whole, view.camera, {}, {}), rest = render({}, cloud, view.camera, {}, {});
    PixelMask hole(std::size_t(kSide_px) * kSide_px);
    for (std::size_t p = 0; p < hole.size(); ++p) hole[p] = full.alpha.data[p] - rest.alpha.data[p] > 0.1f;
    views.push_back(scene.views.size());
    scene.views.push_back(view);
    pictures.push_back(full.colour);
    holes.push_back(hole);
  }
  HoleRefit refit(int threads, GaussianCloud& result) const {
    Monitor monitor;
    result = cloud;
    const InpaintedViews input{scene,
                               views,
                               [&](std::size_t v) { return pictures[v]; },
                               [&](std::size_t v) -> const PixelMask& { return holes[v]; },
                               {},
                               {0, 0, 0},
                               0};
    return refit_hole({.threads = threads}, monitor, input, std::size_t(cloud.size()), result);
  }
};

}  // namespace

TEST_CASE("a hole is seeded and refitted to the pictures; rows of the background keep their bits") {
  const RefitCase c(3);
  GaussianCloud result;
  const HoleRefit found = c.refit(1, result);
  CHECK(found.seeds > 10);
  CHECK(result.size() == c.cloud.size() + found.seeds);
  CHECK(found.psnr_after_db > 25);
  CHECK(found.psnr_after_db > found.psnr_before_db + 2);
  const auto kept = std::size_t(c.cloud.size());
  CHECK(std::equal(c.cloud.position.begin(), c.cloud.position.end(), result.position.begin()));
  CHECK(std::equal(c.cloud.sh_dc.begin(), c.cloud.sh_dc.end(), result.sh_dc.begin()));
  CHECK(std::equal(c.cloud.logit_opacity.begin(), c.cloud.logit_opacity.end(), result.logit_opacity.begin()));
  double red = 0;
  for (std::size_t i = kept; i < std::size_t(result.size()); ++i) red += double(colour_of_dc(result.sh_dc[3 * i]));
  CHECK(red / double(found.seeds) > 0.6);
}

TEST_CASE("a refit has the same bytes for every number of threads") {
  const RefitCase c(2);
  GaussianCloud one, three;
  c.refit(1, one);
  c.refit(3, three);
  CHECK(one.position == three.position);
  CHECK(one.sh_dc == three.sh_dc);
  CHECK(one.log_scale == three.log_scale);
}

TEST_CASE("without views a refit changes nothing") {
  const RefitCase c(0);
  GaussianCloud result;
  const HoleRefit found = c.refit(1, result);
  CHECK(found.seeds == 0);
  CHECK(result.size() == c.cloud.size());
}

}  // namespace ngs
