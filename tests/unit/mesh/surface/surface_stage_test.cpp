#include "ngs/mesh/surface/surface_stage.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/mesh/measures.h"
#include "support/error_code.h"
#include "support/mesh_truth.h"
#include "support/quiet.h"
#include "support/random.h"

namespace ngs {
namespace {

constexpr double kNear = 0.03;  // 1.5 cells of the ball at 64 cells

synth::AnalyticScene ball_scene() {
  return {.objects = {{"ball", {synth::sphere({0.2, 0, 0.1}, 0.6)}, {}}}, .room = {}};
}

mesh::ObjectMesh mesh_of(const GaussianCloud& cloud, int threads = 2) {
  return mesh::mesh_of({.threads = threads}, test::Quiet(), cloud, {.faces = 3000, .resolution = 64});
}

void check_stage_closed(const TriangleMesh& mesh) {
  const mesh::MeshMeasures found = mesh::measures_of(mesh);
  CHECK(found.border_edges == 0);
  CHECK(found.non_manifold_edges == 0);
}

TEST_CASE("discs on a ball become a closed mesh of the ball in its colours, the same for any number of threads") {
  const synth::AnalyticScene scene = ball_scene();
  const GaussianCloud cloud = test::splat_of(scene.objects[0], 4000);
  const mesh::ObjectMesh object = mesh_of(cloud, 1), again = mesh_of(cloud, 3);
  check_stage_closed(object.mesh);
  CHECK(object.mesh.faces.size() <= 3000);
  CHECK(object.pieces.kept == 1);
  const test::MeshScore score = test::score_of(object.mesh, scene, 0, {}, kNear);
  CHECK(score.iou > 0.95);
  CHECK(score.to_truth < 0.5 * object.cell);
  CHECK(score.seen_within > 0.99);
  double error = 0;
  for (std::uint32_t v = 0; v < object.mesh.vertices.size(); ++v) {
    const Vec3<double> truth = synth::albedo(scene.objects[0].texture, object.mesh.at(v));
    error += std::abs(double(object.mesh.colours[v].x) - truth.x) / double(object.mesh.vertices.size());
  }
  CHECK(error < 0.05);
  CHECK(object.mesh.faces == again.mesh.faces);
  for (std::uint32_t v = 0; v < object.mesh.vertices.size(); ++v)
    REQUIRE(length(object.mesh.at(v) - again.mesh.at(v)) == 0);
}

TEST_CASE("a shell that is open below, as no photo shows the underside, is closed there and filled") {
  const synth::AnalyticScene scene = ball_scene();
  GaussianCloud cloud = test::splat_of(scene.objects[0], 4000);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i)
    if (cloud.position[3 * i + 2] < -0.2f) cloud.usable[i] = 0;
  const mesh::ObjectMesh object = mesh_of(cloud);
  check_stage_closed(object.mesh);
  const double height = 0.9;  // of the part of the ball above z = -0.2
  const double cap = 3.141592653589793 * height * height * (0.6 - height / 3);
  CHECK(mesh::measures_of(object.mesh).volume == doctest::Approx(cap).epsilon(0.05));
}

/// The part of a ball of discs above z = -0.2, with notches 0.08 deep in its lower edge.
GaussianCloud ragged_shell() {
  GaussianCloud cloud = test::splat_of(ball_scene().objects[0], 4000);
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    const float* p = &cloud.position[3 * i];
    const double notch = 0.04 * (1 + std::sin(9 * std::atan2(double(p[1]), double(p[0]) - 0.2)));
    if (double(p[2]) < -0.2 + notch) cloud.usable[i] = 0;
  }
  return cloud;
}

/// The area of the faces within `near` of the plane z = -0.2.
double area_at_floor(const TriangleMesh& mesh, double near) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.faces)
    if (std::ranges::all_of(std::array{a, b, c}, [&](auto v) { return std::abs(mesh.at(v).z + 0.2) < near; }))
      area += 0.5 * length(cross(mesh.at(b) - mesh.at(a), mesh.at(c) - mesh.at(a)));
  return area;
}

TEST_CASE("a shell with a ragged lower edge is closed flat by the plane that it stood on, in the colours of its edge") {
  FillSurface floor{.origin = {0, 0, -0.2}, .relief = {}, .tolerance = 0.02};
  mesh::MeshOptions options{.faces = 0, .resolution = 64};
  const GaussianCloud cloud = ragged_shell();
  const mesh::ObjectMesh ragged = mesh::mesh_of({.threads = 2}, test::Quiet(), cloud, options);
  const mesh::ObjectMesh object = mesh::mesh_of({.threads = 2}, test::Quiet(), cloud, options, {floor});
  check_stage_closed(object.mesh);
  const double base = 3.141592653589793 * (0.36 - 0.09);
  CHECK(area_at_floor(object.mesh, 0.5 * object.cell) > 0.85 * base);
  CHECK(area_at_floor(ragged.mesh, 0.5 * object.cell) < 0.2 * base);
  const double cap = 3.141592653589793 * 0.81 * (0.6 - 0.3);
  CHECK(mesh::measures_of(object.mesh).volume == doctest::Approx(cap).epsilon(0.05));
  for (std::uint32_t v = 0; v < object.mesh.vertices.size(); ++v) CHECK(object.mesh.at(v).z > -0.2 - 1e-5);
  const auto is_grey = [](auto c) { return c.x == 0.5f && c.y == 0.5f && c.z == 0.5f; };
  CHECK(std::ranges::count_if(object.mesh.colours, is_grey) < 10);  // by chance
}

TEST_CASE("the floor of a scene is the plane that its object stands on; a floor far below supports nothing") {
  const GaussianCloud shell = ragged_shell();
  const auto floor_at = [](double z) {
    const synth::Object floor{
        "floor", {synth::box({0.2, 0, z - 0.05}, synth::frame_with_z({0, 0, 1}), {2, 2, 0.05}, 0)}, {}};
    GaussianCloud cloud = test::splat_of(floor, 6000);
    cloud.origin = {0, 0, 1};  // of another file
    for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
      cloud.usable[i] = double(cloud.position[3 * i + 2]) > z - 0.01;  // not its lower side
      cloud.position[3 * i + 2] -= 1;
    }
    return cloud;
  };
  const std::vector<FillSurface> planes = mesh::planes_behind({.threads = 2}, shell, floor_at(-0.2), 0);
  REQUIRE(planes.size() == 1);
  CHECK(planes[0].normal.z > 0.999);
  CHECK(planes[0].height({0.2, 0, -0.2}) == doctest::Approx(0).scale(1).epsilon(0.01));
  CHECK(mesh::planes_behind({.threads = 2}, shell, floor_at(-2), 0).empty());
  CHECK(mesh::planes_behind({.threads = 2}, shell, {}, 0).empty());
}

TEST_CASE("a ring keeps its hole, two balls stay two pieces") {
  synth::AnalyticScene scene;
  scene.objects = {{"ring", {synth::torus({0, 0, 0}, synth::frame_with_z({0.2, 0.3, 1}), 0.5, 0.15)}, {}},
                   {"balls", {synth::sphere({-0.5, 0, 0}, 0.3), synth::sphere({0.5, 0, 0}, 0.3)}, {}}};
  const mesh::ObjectMesh ring = mesh_of(test::splat_of(scene.objects[0], 4000));
  check_stage_closed(ring.mesh);
  CHECK(std::ssize(ring.mesh.vertices) == std::ssize(ring.mesh.faces) / 2);  // Euler number 0
  CHECK(test::score_of(ring.mesh, scene, 0, {}, kNear).iou > 0.9);
  const GaussianCloud balls = test::splat_of(scene.objects[1], 4000);
  const mesh::ObjectMesh two = mesh_of(balls), again = mesh_of(balls, 3);
  CHECK(two.pieces.kept == 2);
  CHECK(two.mesh.faces == again.mesh.faces);
}

TEST_CASE("a foam, whose tunnels need more faces than allowed, is extracted from a coarser grid") {
  synth::Object foam{"foam", {}, {}};
  test::Random random(3);
  for (int k = 0; k < 60; ++k)
    foam.solids.push_back(
        synth::sphere({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}, 0.14));
  mesh::MeshOptions options{.faces = 100, .resolution = 128};
  Monitor monitor;
  const mesh::ObjectMesh object = mesh::mesh_of({.threads = 2}, monitor, test::splat_of(foam, 8000), options);
  check_stage_closed(object.mesh);
  CHECK(object.mesh.faces.size() <= 100);
  REQUIRE(monitor.warnings().size() == 1);
  CHECK(monitor.warnings()[0].find("--faces 100: the tunnels and pieces of the surface need") == 0);
}

TEST_CASE("the mesh of a capture shows its middle, and a warning names the surroundings") {
  GaussianCloud cloud = test::splat_of(ball_scene().objects[0], 4000);
  for (std::size_t i = 0; i < 3 * 400; ++i) cloud.position[i] *= 60;
  Monitor monitor;
  check_stage_closed(mesh::mesh_of({.threads = 2}, monitor, cloud, {.resolution = 32}).mesh);
  REQUIRE(monitor.warnings().size() == 1);
  CHECK(monitor.warnings()[0].find("like a capture with its surroundings") != std::string::npos);
}

TEST_CASE("too few, transparent and unusable Gaussians are refused") {
  GaussianCloud few = test::splat_of(ball_scene().objects[0], 9);
  CHECK(test::code_of([&] { mesh_of(few); }) == ErrorCode::kNothingFound);
  GaussianCloud faint = test::splat_of(ball_scene().objects[0], 500);
  for (float& logit : faint.logit_opacity) logit = -4;
  CHECK(test::code_of([&] { mesh_of(faint); }) == ErrorCode::kNothingFound);
  CHECK(test::code_of([&] { mesh_of({}); }) == ErrorCode::kNothingFound);
}

}  // namespace
}  // namespace ngs
