#include "ngs/mesh/surface/iso_surface.h"

#include <doctest/doctest.h>

#include <numbers>

#include "ngs/core/error.h"
#include "ngs/core/rng.h"
#include "ngs/mesh/measures.h"
#include "ngs/mesh/simplify.h"

namespace ngs {
namespace {

using Vec = Vec3<double>;

mesh::SampleGrid grid_of(int blocks) {
  const double cell = 2.4 / (blocks * mesh::kBlockCells);
  return {.low = {-1.2, -1.2, -1.2}, .cell = cell, .blocks = {blocks, blocks, blocks}};
}

std::vector<std::uint32_t> all_blocks(const mesh::SampleGrid& grid) {
  std::vector<std::uint32_t> blocks(grid.block_count());
  for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = std::uint32_t(b);
  return blocks;
}

template <class Distance>
TriangleMesh surface_of(const mesh::SampleGrid& grid, const std::vector<std::uint32_t>& seeds, int threads,
                        const Distance& distance) {
  return mesh::iso_surface({.threads = threads}, grid, seeds, [&](std::array<int, 3> low, std::vector<float>& values) {
    constexpr int kSide = mesh::kBlockCells + 1;
    for (std::size_t k = 0; k < values.size(); ++k)
      values[k] = float(
          distance(grid.at(low[0] + int(k) % kSide, low[1] + int(k) / kSide % kSide, low[2] + int(k) / kSide / kSide)));
  });
}

double sphere(Vec p) { return length(p) - 1; }
double ring(Vec p) {
  const double across = std::sqrt(p.x * p.x + p.y * p.y) - 0.7;
  return std::sqrt(across * across + p.z * p.z) - 0.3;
}

/// Vertices - edges + faces, of a closed mesh.
std::int64_t euler_number(const TriangleMesh& mesh) { return std::ssize(mesh.vertices) - std::ssize(mesh.faces) / 2; }

void check_closed(const TriangleMesh& mesh) {
  const mesh::MeshMeasures found = mesh::measures_of(mesh);
  CHECK(found.border_edges == 0);
  CHECK(found.non_manifold_edges == 0);
}

TEST_CASE("the surface of a sphere is closed, points outwards, and has its volume, area and Euler number") {
  const mesh::SampleGrid grid = grid_of(6);
  const TriangleMesh mesh = surface_of(grid, all_blocks(grid), 1, sphere);
  check_closed(mesh);
  CHECK(euler_number(mesh) == 2);
  const mesh::MeshMeasures found = mesh::measures_of(mesh);
  CHECK(found.volume == doctest::Approx(4 * std::numbers::pi / 3).epsilon(0.005));
  CHECK(found.area == doctest::Approx(4 * std::numbers::pi).epsilon(0.005));
}

TEST_CASE("a surface is followed from one block, and any number of threads gives the same mesh") {
  const mesh::SampleGrid grid = grid_of(5);
  const TriangleMesh all = surface_of(grid, all_blocks(grid), 1, ring);
  CHECK(euler_number(all) == 0);
  const TriangleMesh one =
      surface_of(grid, {std::uint32_t(grid.block_count() / 2)}, 1, [](Vec p) { return length(p) - 0.2; });
  CHECK(mesh::measures_of(one).volume == doctest::Approx(0.0335).epsilon(0.05));
  std::vector<std::uint32_t> touched;  // the block at the end of the ring
  touched.push_back(std::uint32_t(4 + 5 * (2 + 5 * 2)));
  const TriangleMesh followed = surface_of(grid, touched, 1, ring), parallel = surface_of(grid, touched, 3, ring);
  CHECK(followed.faces.size() == all.faces.size());
  CHECK(followed.faces == parallel.faces);
  CHECK(mesh::measures_of(followed).volume == mesh::measures_of(parallel).volume);
  CHECK(surface_of(grid, {}, 1, ring).faces.empty());
}

TEST_CASE("values without any order, NaN and a surface beyond the border still give a closed 2-manifold") {
  const mesh::SampleGrid grid = grid_of(3);
  const auto noise = [&](Vec p) {
    const Vec at = (1 / grid.cell) * (p - grid.low);
    const auto index = std::uint64_t(std::lround(at.x) + 100 * std::lround(at.y) + 10000 * std::lround(at.z));
    const double value = rng_uniform(7, RngStream::kTest, index) - 0.5;
    return value > 0.48 ? std::nan("") : value;
  };
  const TriangleMesh mesh = surface_of(grid, all_blocks(grid), 1, noise);
  CHECK(mesh.faces.size() > 10000);
  check_closed(mesh);
  const TriangleMesh box = surface_of(grid, all_blocks(grid), 1, [](Vec) { return -1.0; });
  check_closed(box);
  CHECK(mesh::measures_of(box).volume == doctest::Approx(std::pow(2.4, 3)).epsilon(0.2));
}

TEST_CASE("simplification keeps a mesh closed, its Euler number and its volume") {
  const mesh::SampleGrid grid = grid_of(6);
  TriangleMesh ball = surface_of(grid, all_blocks(grid), 1, sphere),
               torus = surface_of(grid, all_blocks(grid), 1, ring);
  const double volume = mesh::measures_of(torus).volume;
  mesh::simplify(400, ball);
  mesh::simplify(800, torus);
  CHECK(ball.faces.size() <= 400);
  CHECK(torus.faces.size() <= 800);
  check_closed(ball);
  check_closed(torus);
  CHECK(euler_number(ball) == 2);
  CHECK(euler_number(torus) == 0);
  CHECK(mesh::measures_of(ball).volume == doctest::Approx(4 * std::numbers::pi / 3).epsilon(0.02));
  CHECK(mesh::measures_of(torus).volume == doctest::Approx(volume).epsilon(0.01));
}

TEST_CASE("a mesh of tunnels stays a closed 2-manifold with the same Euler number down to the last edge") {
  const mesh::SampleGrid grid = grid_of(2);
  TriangleMesh mesh = surface_of(grid, all_blocks(grid), 1, [&](Vec p) {
    const Vec at = (1 / grid.cell) * (p - grid.low);
    const auto index = std::uint64_t(std::lround(at.x) + 100 * std::lround(at.y) + 10000 * std::lround(at.z));
    return rng_uniform(11, RngStream::kTest, index) - 0.5;
  });
  const std::int64_t before = euler_number(mesh);
  const std::size_t faces = mesh.faces.size();
  mesh::simplify(4, mesh);
  CHECK(mesh.faces.size() < faces / 2);
  check_closed(mesh);
  CHECK(euler_number(mesh) == before);
}

TEST_CASE("crumbs and cavities are removed, a second large piece stays") {
  const mesh::SampleGrid grid = grid_of(6);
  TriangleMesh mesh = surface_of(grid, all_blocks(grid), 1, [](Vec p) {
    const double shell = std::max(length(p + Vec{0.5, 0, 0}) - 0.5, 0.3 - length(p + Vec{0.5, 0, 0}));
    return std::min({shell, length(p - Vec{0.6, 0, 0}) - 0.4, length(p - Vec{0, 0.9, 0}) - 0.06});
  });
  const mesh::PieceCounts found = mesh::keep_pieces(0.05, mesh);
  CHECK(found.kept == 2);
  CHECK(found.crumbs == 1);
  CHECK(found.cavities == 1);
  check_closed(mesh);
  CHECK(mesh::measures_of(mesh).volume == doctest::Approx(4 * std::numbers::pi / 3 * (0.125 + 0.064)).epsilon(0.02));
  CHECK(euler_number(mesh) == 4);
}

/// The corner of the unit cube at the origin, with 3 edges along the axes.
TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}};
}

TEST_CASE("a tetrahedron has its volume and area, and is watertight") {
  const mesh::MeshMeasures found = mesh::measures_of(tetrahedron());
  CHECK(found.volume == doctest::Approx(1 / 6.0));
  CHECK(found.area == doctest::Approx(1.5 + std::sqrt(3) / 2));
  CHECK(found.border_edges == 0);
  CHECK(found.non_manifold_edges == 0);
}

TEST_CASE("a missing face leaves three border edges, a face turned over repeats three") {
  TriangleMesh open = tetrahedron();
  open.faces.pop_back();
  CHECK(mesh::measures_of(open).border_edges == 3);
  TriangleMesh turned = tetrahedron();
  std::swap(turned.faces[3][0], turned.faces[3][1]);
  CHECK(mesh::measures_of(turned).non_manifold_edges == 3);
  CHECK(mesh::measures_of({}).volume == 0);
}

TEST_CASE("a face that names a vertex that does not exist is refused") {
  TriangleMesh broken = tetrahedron();
  broken.faces[0][0] = 4;
  CHECK_THROWS_AS(mesh::measures_of(broken), Error);
}

}  // namespace
}  // namespace ngs
