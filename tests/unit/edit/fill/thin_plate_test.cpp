#include "ngs/edit/fill/thin_plate.h"

#include <doctest/doctest.h>

#include <cmath>

namespace ngs {
namespace {

/// Points around a hole of radius 0.5, on a dome.
struct Dome {
  std::vector<Vec2<double>> points;
  std::vector<double> heights;

  static double at(double u, double v) { return 1 - 0.3 * (u * u + v * v) + 0.2 * u; }
  Dome() {
    for (int j = -5; j <= 5; ++j)
      for (int i = -5; i <= 5; ++i) {
        const double u = 0.2 * i, v = 0.2 * j;
        if (u * u + v * v > 0.25) points.push_back({u, v}), heights.push_back(at(u, v));
      }
  }
};

}  // namespace

TEST_CASE("a thin plate passes through its points, and continues a dome into the hole") {
  const Dome dome;
  const ThinPlate plate(dome.points, dome.heights, 0);
  for (std::size_t i = 0; i < dome.points.size(); ++i)
    CHECK(plate.at(dome.points[i].x, dome.points[i].y) == doctest::Approx(dome.heights[i]).epsilon(1e-8));
  CHECK(std::abs(plate.at(0, 0) - Dome::at(0, 0)) < 0.02);  // the mean of the rim is 0.15 lower
  CHECK(std::abs(plate.at(0.2, -0.1) - Dome::at(0.2, -0.1)) < 0.02);
}

TEST_CASE("a thin plate through points of a plane is that plane, far outside of them too") {
  std::vector<double> heights;
  const Dome dome;
  for (const Vec2<double>& p : dome.points) heights.push_back(3 + 2 * p.x - p.y);
  const ThinPlate plate(dome.points, heights, 1e-3);
  CHECK(plate.at(10, -20) == doctest::Approx(43).epsilon(1e-6));
}

TEST_CASE("a thin plate of fewer than three points, coincident points or points on a line is empty and 0") {
  CHECK(ThinPlate().at(1, 2) == 0);
  CHECK(ThinPlate({}, {}, 0).empty());
  CHECK(ThinPlate({{0, 0}, {1, 0}}, {1, 2}, 0).empty());
  CHECK(ThinPlate({{1, 1}, {1, 1}, {1, 1}}, {1, 2, 3}, 0).empty());
  CHECK(ThinPlate({{0, 0}, {1, 1}, {2, 2}, {3, 3}}, {1, 2, 0, 5}, 0).empty());
  CHECK_FALSE(ThinPlate({{0, 0}, {1, 0}, {0, 1}}, {1, 2, 3}, 0).empty());
}

}  // namespace ngs
