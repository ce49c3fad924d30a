#include "ngs/mesh/collider/collider.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/mesh/collider/convex_parts.h"
#include "ngs/mesh/collider/oriented_box.h"
#include "ngs/mesh/measures.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs::mesh {
namespace {

constexpr double kRayCells = 4e5;  // of the rays' lattice in the mesh or, if that needs more rays, fewer
constexpr double kMostRaysAcross = 450;
constexpr std::size_t kMostPlaces = 100000;  // whose distance to the mesh is measured

/// The volume of the mesh, world units^3. Throws if it is empty, open or turned over.
double closed_volume(const TriangleMesh& mesh) {
  if (mesh.faces.empty())
    throw Error(ErrorCode::kNothingFound, "mesh: has no faces, expected a closed surface", "check the object");
  const MeshMeasures measures = measures_of(mesh);
  if (measures.border_edges > 0)
    throw Error(ErrorCode::kInconsistent,
                "mesh: has " + std::to_string(measures.border_edges) + " open edges, expected a closed surface",
                "close the holes of the mesh");
  if (!(measures.volume > 0))
    throw Error(ErrorCode::kInconsistent, "mesh: encloses no volume, expected faces that point outwards",
                "turn the faces over");
  return measures.volume;
}

GridMesh on_grid(const TriangleMesh& mesh, const ExactGrid& grid) {
  GridMesh result;
  for (const Vec3<float>& v : mesh.vertices) result.vertices.push_back(grid.of(v));
  result.faces = mesh.faces;
  return result;
}

TriangleMesh in_world(const GridMesh& mesh, const ExactGrid& grid) {
  TriangleMesh result;
  for (const GridPoint& p : mesh.vertices) {
    const Vec3<double> v = grid.world(p);
    result.vertices.push_back({float(v.x), float(v.y), float(v.z)});
  }
  result.faces = mesh.faces;
  return result;
}

/// Corner k of a box has the sign of bit a of k along axis a. It may lie a little outside the grid.
GridMesh box_mesh(const OrientedBox& box) {
  GridMesh mesh;
  for (unsigned k = 0; k < 8; ++k) {
    const auto sign = [k](unsigned axis) { return (k >> axis & 1) != 0 ? 1.0 : -1.0; };
    const Vec3<double> p = box.centre + (sign(0) * box.half.x) * box.axes[0] + (sign(1) * box.half.y) * box.axes[1] +
                           (sign(2) * box.half.z) * box.axes[2];
    mesh.vertices.push_back({std::llround(p.x), std::llround(p.y), std::llround(p.z)});
  }
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

std::vector<GridMesh> parts_of(const Exec& exec, const GridMesh& solid, double volume, const ColliderChoice& choice) {
  if (choice.kind == ColliderKind::kBox)
    return {box_mesh(oriented_box(convex_hull(solid.vertices, solid.vertices.size())))};
  std::vector<ConvexHull> hulls;
  if (choice.kind == ColliderKind::kHull) hulls.push_back(convex_hull(solid.vertices, kColliderCorners));
  if (choice.kind == ColliderKind::kConvex) hulls = convex_parts(exec, solid, volume, choice.parts);
  std::vector<GridMesh> parts;
  for (const ConvexHull& hull : hulls) {
    ConvexHull small = convex_hull(hull.vertices, kColliderCorners);
    parts.push_back({std::move(small.vertices), std::move(small.faces)});
  }
  return parts;
}

/// Corners, and points between them where an edge is longer than `spacing`.
std::vector<float> surface_samples(const GridMesh& mesh, double spacing) {
  std::vector<float> samples;
  const auto add = [&samples](Vec3<double> p) {
    for (const double x : {p.x, p.y, p.z}) samples.push_back(float(x));
  };
  for (const GridPoint& p : mesh.vertices) add(to_double(p));
  for (const auto& face : mesh.faces) {
    const Vec3<double> a = to_double(mesh.vertices[face[0]]);
    const Vec3<double> b = to_double(mesh.vertices[face[1]]) - a;
    const Vec3<double> c = to_double(mesh.vertices[face[2]]) - a;
    const int n = std::max(1, int(std::ceil(std::max({length(b), length(c), length(c - b)}) / spacing)));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        if ((i > 0 && i < n) || (j > 0 && j < n)) add(a + (double(i) / n) * b + (double(j) / n) * c);
  }
  return samples;
}

double greatest_distance(const Exec& exec, const GridMesh& solid, const std::vector<GridPoint>& places, double pitch) {
  if (places.empty()) return 0;
  std::vector<float> queries;
  const std::size_t step = 1 + places.size() / kMostPlaces;
  for (std::size_t i = 0; i < places.size(); i += step)
    for (const std::int64_t x : {places[i].x, places[i].y, places[i].z}) queries.push_back(float(x));
  const std::vector<float> samples = surface_samples(solid, pitch);
  const auto rows = [](const std::vector<float>& values) {
    return Rows<const float, 3>{values.data(), std::int64_t(values.size() / 3)};
  };
  const KnnGraph nearest = nearest_points(exec, rows(samples), rows(queries), 1);
  return std::sqrt(double(*std::ranges::max_element(nearest.dist2)));
}

}  // namespace

ColliderChoice collider_choice(const std::string& text) {
  constexpr int kMostParts = 1024;
  if (text == "box") return {ColliderKind::kBox, 1};
  if (text == "hull") return {ColliderKind::kHull, 1};
  if (text.rfind("convex:", 0) == 0)
    if (int parts = 0; parse_number(text.substr(7), parts) && parts >= 1 && parts <= kMostParts)
      return {ColliderKind::kConvex, parts};
  throw Error(
      ErrorCode::kUsage,
      "--collider: \"" + text + "\", expected box, hull or convex:N with N from 1 to " + std::to_string(kMostParts),
      "use --collider convex:16");
}

Collider make_collider(const Exec& exec, const TriangleMesh& mesh, const ColliderChoice& choice) {
  const ExactGrid grid(mesh.vertices);
  Collider collider;
  collider.mesh_volume = closed_volume(mesh);
  const double cell = grid.step() * grid.step() * grid.step();
  const double volume = collider.mesh_volume / cell;
  const GridMesh solid = on_grid(mesh, grid);
  const std::vector<GridMesh> parts = parts_of(exec, solid, volume, choice);
  if (parts.empty())
    throw Error(ErrorCode::kInconsistent, "mesh: is flat, expected a surface that encloses a volume",
                "check the object");
  for (const GridMesh& part : parts) collider.parts.push_back(in_world(part, grid));
  const auto pitch = std::int64_t(std::max(std::cbrt(volume / kRayCells), double(kGridCells) / kMostRaysAcross));
  const Difference difference = difference_of(solid, parts, pitch);
  collider.outside_share = difference.in_parts_only / volume;
  collider.missing_share = difference.in_mesh_only / volume;
  collider.outside_distance = grid.step() * greatest_distance(exec, solid, difference.outside, double(pitch));
  return collider;
}

}  // namespace ngs::mesh
