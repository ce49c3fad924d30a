#include "ngs/mesh/collider/convex_hull.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "support/random.h"

namespace ngs::mesh {
namespace {

constexpr std::size_t kAll = 1000000;

std::vector<GridPoint> cube_corners(std::int64_t side) {
  std::vector<GridPoint> points;
  for (int k = 0; k < 8; ++k) points.push_back({(k & 1) * side, (k >> 1 & 1) * side, (k >> 2) * side});
  return points;
}

/// Every directed edge occurs once and so does its reverse, and no point lies in front of a face.
void check_hull(const ConvexHull& hull, const std::vector<GridPoint>& points) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& f : hull.faces)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{f[k], f[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    CHECK(count == 1);
    CHECK(edges.count({edge.second, edge.first}) == 1);
  }
  std::int64_t highest = 0;
  for (const auto& [a, b, c] : hull.faces)
    for (const GridPoint& p : points)
      highest = std::max(highest, orient(hull.vertices[a], hull.vertices[b], hull.vertices[c], p));
  CHECK(highest == 0);
  CHECK(hull.faces.size() == 2 * hull.vertices.size() - 4);  // Euler
}

TEST_CASE("the hull of a cube with points inside and on its faces has the 8 corners, 12 faces and its volume") {
  std::vector<GridPoint> points{{500, 500, 500}, {0, 500, 500}, {1000, 0, 500}, {1, 999, 2}};
  for (const GridPoint& p : cube_corners(1000)) points.push_back(p);
  const ConvexHull hull = convex_hull(points, kAll);
  CHECK(hull.volume == 1e9);
  check_hull(hull, points);
  for (const GridPoint& corner : cube_corners(1000))
    CHECK(std::ranges::count_if(
              hull.vertices, [&](GridPoint v) { return v.x == corner.x && v.y == corner.y && v.z == corner.z; }) == 1);
}

TEST_CASE("points that span no volume have an empty hull: none, one, three, coincident, collinear, coplanar") {
  const std::vector<GridPoint> three{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
  std::vector<GridPoint> flat, line;
  for (int k = 0; k < 20; ++k) {
    flat.push_back({k % 5, k / 5, k % 5 + 2 * (k / 5)});
    line.push_back({k, 2 * k, 3 * k});
  }
  for (const std::vector<GridPoint>& points :
       {std::vector<GridPoint>{}, {{5, 5, 5}}, three, std::vector<GridPoint>(7, GridPoint{3, 3, 3}), line, flat}) {
    const ConvexHull hull = convex_hull(points, kAll);
    CHECK(hull.vertices.empty());
    CHECK(hull.faces.empty());
    CHECK(hull.volume == 0);
  }
}

TEST_CASE("the hull of a lattice, full of coplanar and collinear points, is closed and convex") {
  std::vector<GridPoint> points;
  for (int k = 0; k < 343; ++k) points.push_back({k % 7 * 3, k / 7 % 7 * 3, k / 49 * 3});
  const ConvexHull hull = convex_hull(points, kAll);
  check_hull(hull, points);
  CHECK(hull.volume == 18 * 18 * 18);
}

TEST_CASE("hulls of random points are closed and convex, over the whole grid and in few cells; 8 vertices hold less") {
  test::Random random(71);
  for (const std::int64_t side : {kGridCells, std::int64_t(12)}) {
    std::vector<GridPoint> points;
    for (int k = 0; k < 400; ++k) points.push_back({random.below(side), random.below(side), random.below(side)});
    const ConvexHull full = convex_hull(points, kAll), small = convex_hull(points, 8);
    check_hull(full, points);
    check_hull(small, small.vertices);
    CHECK(small.vertices.size() <= 8);
    CHECK(small.volume < full.volume);
  }
}

TEST_CASE("the farthest corners of the grid are exact") {
  std::vector<GridPoint> points = cube_corners(kGridCells);
  const ConvexHull hull = convex_hull(points, kAll);
  CHECK(hull.volume == double(kGridCells) * double(kGridCells) * double(kGridCells));
  check_hull(hull, points);
}

}  // namespace
}  // namespace ngs::mesh
