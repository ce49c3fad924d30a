#include "ngs/mesh/measures.h"

#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs {
namespace {

/// The corner of the unit cube at the origin, with 3 edges along the axes.
TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
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
