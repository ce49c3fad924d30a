#include "ngs/mesh/collider/collider.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "ngs/core/error.h"
#include "ngs/mesh/collider/convex_hull.h"
#include "ngs/mesh/measures.h"
#include "support/error_code.h"
#include "support/mesh_truth.h"
#include "support/random.h"

namespace ngs::mesh {
namespace {

ErrorCode code_of(const TriangleMesh& mesh) {
  return test::code_of([&] { make_collider({}, mesh, {ColliderKind::kConvex, 4}); });
}

/// A prism over an L of three unit squares, between z = 0 and 1.
TriangleMesh l_prism() {
  TriangleMesh mesh;
  for (const float z : {0.f, 1.f})
    for (const auto& [x, y] : std::vector<std::pair<float, float>>{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})
      mesh.vertices.push_back({x, y, z});
  for (const auto& [a, b, c] : std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    mesh.faces.push_back({a, c, b});
    mesh.faces.push_back({a + 6, b + 6, c + 6});
  }
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::uint32_t next = (k + 1) % 6;
    mesh.faces.push_back({k, next, next + 6});
    mesh.faces.push_back({k, next + 6, k + 6});
  }
  return mesh;
}

double sum_of_volumes(const Collider& collider) {
  double sum = 0;
  for (const TriangleMesh& part : collider.parts) sum += measures_of(part).volume;
  return sum;
}

TEST_CASE("an L becomes two boxes without volume outside or missing; its hull adds the triangle across the notch") {
  const Collider two = make_collider({}, l_prism(), {ColliderKind::kConvex, 2});
  REQUIRE(two.parts.size() == 2);
  CHECK(sum_of_volumes(two) == doctest::Approx(3).epsilon(1e-5));
  CHECK(two.outside_share < 1e-4);
  CHECK(two.missing_share < 1e-4);
  const Collider four = make_collider({}, l_prism(), {ColliderKind::kConvex, 4});
  CHECK(four.parts.size() == 2);  // more parts are not needed
  const Collider hull = make_collider({}, l_prism(), {ColliderKind::kHull, 1});
  REQUIRE(hull.parts.size() == 1);
  CHECK(hull.outside_share == doctest::Approx(0.5 / 3).epsilon(0.01));
  CHECK(hull.outside_distance == doctest::Approx(0.5).epsilon(0.03));  // at the middle of the hull's edge
  const Collider one = make_collider({}, l_prism(), {ColliderKind::kConvex, 1});
  CHECK(sum_of_volumes(one) == doctest::Approx(3.5).epsilon(1e-5));
}

TEST_CASE("a turned box is its own box; the box of an L is the square around it") {
  const Mat3<double> turn = synth::frame_with_z({0.3, 0.5, 0.8});
  TriangleMesh cube;
  for (int k = 0; k < 8; ++k) {
    const Vec3<double> p = turn * Vec3<double>{k & 1 ? 3. : 0., k & 2 ? 2. : 0., k & 4 ? 1. : 0.};
    cube.vertices.push_back({float(p.x), float(p.y), float(p.z)});
  }
  cube.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const Collider box = make_collider({}, cube, {ColliderKind::kBox, 1});
  CHECK(sum_of_volumes(box) == doctest::Approx(6).epsilon(1e-4));
  CHECK(measures_of(box.parts[0]).border_edges == 0);
  const Collider square = make_collider({}, l_prism(), {ColliderKind::kBox, 1});
  CHECK(sum_of_volumes(square) == doctest::Approx(4).epsilon(1e-4));
  CHECK(square.outside_share == doctest::Approx(1.0 / 3).epsilon(0.01));
  CHECK(square.missing_share < 1e-4);
}

TEST_CASE("a torus becomes closed convex parts of at most 64 corners, the same for 1 and 3 threads") {
  const TriangleMesh torus = test::true_mesh(test::recipe_object("torus-box", "torus"), 48);
  const Collider a = make_collider({}, torus, {ColliderKind::kConvex, 8});
  const Collider b = make_collider({.threads = 3}, torus, {ColliderKind::kConvex, 8});
  CHECK(a.parts.size() <= 8);
  CHECK(a.outside_share < 0.15);
  REQUIRE(a.parts.size() == b.parts.size());
  for (std::size_t i = 0; i < a.parts.size(); ++i) {
    CHECK(a.parts[i].vertices.size() <= kColliderCorners);
    const MeshMeasures measures = measures_of(a.parts[i]);
    CHECK(measures.border_edges == 0);
    CHECK(measures.volume > 0);
    REQUIRE(a.parts[i].faces == b.parts[i].faces);
    for (std::uint32_t v = 0; v < a.parts[i].vertices.size(); ++v)
      CHECK(length(a.parts[i].at(v) - b.parts[i].at(v)) == 0);
  }
}

namespace {

bool is_inside(const TriangleMesh& convex, Vec3<double> p) {
  return std::ranges::all_of(convex.faces, [&](const auto& face) {
    const auto corner = [&](std::size_t i) { return convex.at(face[i]); };
    return dot(cross(corner(1) - corner(0), corner(2) - corner(0)), p - corner(0)) <= 0;
  });
}

}  // namespace

TEST_CASE("volumes outside and missing equal those of a brute force over points of the parts and the analytic solid") {
  const synth::Object torus = test::recipe_object("torus-box", "torus");
  const Collider collider =
      make_collider({}, test::true_mesh(test::recipe_object("torus-box", "torus"), 96), {ColliderKind::kConvex, 6});
  std::size_t outside = 0;
  std::size_t missing = 0;
  std::size_t inside = 0;
  constexpr int kSide = 120;
  for (int k = 0; k < kSide * kSide * kSide; ++k) {
    const auto along = [](double low, double high, int i) { return low + (high - low) * (i + 0.5) / kSide; };
    const Vec3<double> p{along(-0.35, 0.9, k % kSide), along(-0.35, 0.35, k / kSide % kSide),
                         along(0, 1.3, k / kSide / kSide)};
    const bool in_torus = test::distance_to(torus, p) < 0;
    const bool in_part =
        std::ranges::any_of(collider.parts, [p](const TriangleMesh& part) { return is_inside(part, p); });
    inside += in_torus;
    outside += in_part && !in_torus;
    missing += in_torus && !in_part;
  }
  REQUIRE(inside > 100000);
  CHECK(collider.outside_share == doctest::Approx(double(outside) / double(inside)).epsilon(0.05));
  CHECK(collider.missing_share == doctest::Approx(double(missing) / double(inside)).epsilon(0.1));
  CHECK(collider.outside_share > 0.05);  // six parts of a ring
}

TEST_CASE("meshes that are empty, open, turned over, flat or not finite are refused") {
  CHECK(code_of({}) == ErrorCode::kNothingFound);
  TriangleMesh open = l_prism();
  open.faces.pop_back();
  CHECK(code_of(open) == ErrorCode::kInconsistent);
  TriangleMesh turned = l_prism();
  for (auto& face : turned.faces) std::swap(face[0], face[1]);
  CHECK(code_of(turned) == ErrorCode::kInconsistent);
  TriangleMesh flat = l_prism();
  for (Vec3<float>& v : flat.vertices) v.z = 1;
  CHECK(code_of(flat) == ErrorCode::kInconsistent);
  TriangleMesh broken = l_prism();
  broken.vertices[3].y = std::numeric_limits<float>::quiet_NaN();
  CHECK(code_of(broken) == ErrorCode::kNumeric);
}

TEST_CASE("the names of colliders: box, hull, convex:N with N from 1 to 1024; all else is an error of usage") {
  CHECK(collider_choice("box").kind == ColliderKind::kBox);
  CHECK(collider_choice("hull").kind == ColliderKind::kHull);
  CHECK(collider_choice("convex:1024").parts == 1024);
  for (const char* text : {"", "mesh", "convex", "convex:", "convex:0", "convex:1025", "convex:8x", "convex:-3", "Box"})
    CHECK_THROWS_AS(collider_choice(text), Error);
}

}  // namespace

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
