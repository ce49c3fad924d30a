#include "ngs/edit/fill/hole_seeds.h"

#include <doctest/doctest.h>

#include <cmath>

#include "ngs/math/sh.h"

namespace ngs {
namespace {

constexpr int kWide_px = 64, kHigh_px = 48;

/// A view that shows the plane n·p = d (camera coordinates) but for a hole.
struct PlaneView {
  Camera camera;
  RenderedView around;
  PixelMask hole = PixelMask(kWide_px * kHigh_px);
  ImageF picture{kWide_px, kHigh_px, 3};
  Vec3<double> normal{0.2, 0.5, 1};
  double distance = 4;

  PlaneView() {
    camera.width_px = kWide_px, camera.height_px = kHigh_px;
    camera.fx = camera.fy = 60, camera.cx = 31, camera.cy = 25;
    camera.rotation = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    around.alpha = ImageF(kWide_px, kHigh_px, 1), around.depth = around.alpha;
    for (int y = 0; y < kHigh_px; ++y)
      for (int x = 0; x < kWide_px; ++x) {
        const Vec3<double> ray{(x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1};
        around.alpha.at(x, y) = 0.9f, around.depth.at(x, y) = float(0.9 * distance / dot(normal, ray));
        picture.at(x, y, 1) = 0.75f;
      }
  }
  void open(int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        hole[around.alpha.index(x, y)] = 1;
        around.alpha.at(x, y) = around.depth.at(x, y) = 0;
      }
  }
  GaussianCloud seeds() const {
    GaussianCloud cloud;
    const std::int64_t added = add_hole_seeds({camera, around, hole, picture}, cloud);
    CHECK(added == cloud.size());
    return cloud;
  }
};

}  // namespace

TEST_CASE("seeds of a hole in a plane lie in the plane, one for each cell, in the picture's colour") {
  PlaneView view;
  view.open(16, 12, 48, 36);
  const GaussianCloud cloud = view.seeds();
  REQUIRE(cloud.size() == 8 * 6);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    const Vec3<double> p{double(cloud.position[3 * i]), double(cloud.position[3 * i + 1]),
                         double(cloud.position[3 * i + 2])};
    CAPTURE(i);
    CHECK(dot(view.normal, p) == doctest::Approx(view.distance).epsilon(0.01));
    CHECK(std::exp(double(cloud.log_scale[3 * i])) == doctest::Approx(0.6 * 4 * p.z / 60).epsilon(1e-5));
    CHECK(colour_of_dc(cloud.sh_dc[3 * i + 1]) == doctest::Approx(0.75).epsilon(1e-5));
    CHECK(colour_of_dc(cloud.sh_dc[3 * i]) == doctest::Approx(0).epsilon(1e-5).scale(1));
  }
}

TEST_CASE("covered pixels of a hole, an empty hole and a view that shows nothing get no seed") {
  PlaneView covered;
  covered.hole.assign(covered.hole.size(), 1);
  CHECK(covered.seeds().size() == 0);
  CHECK(PlaneView().seeds().size() == 0);
  PlaneView nothing;
  nothing.open(0, 0, kWide_px, kHigh_px);
  CHECK(nothing.seeds().size() == 0);
}

TEST_CASE("seeds are added behind the rows of a cloud, with its degree") {
  PlaneView view;
  view.open(20, 20, 24, 24);
  GaussianCloud cloud;
  cloud.resize(3, 2);
  cloud.position[0] = 7;
  CHECK(add_hole_seeds({view.camera, view.around, view.hole, view.picture}, cloud) == 1);
  CHECK(cloud.size() == 4);
  CHECK(cloud.position[0] == 7);
  CHECK(cloud.sh_rest.size() == 4 * 3 * 8);
  CHECK(cloud.sh_rest.back() == 0);
}

}  // namespace ngs
