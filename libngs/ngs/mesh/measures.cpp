#include "ngs/mesh/measures.h"

#include <algorithm>
#include <string>
#include <utility>

#include "ngs/core/error.h"

namespace ngs::mesh {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Every directed edge of every face, sorted.
std::vector<Edge> directed_edges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.faces.size());
  for (const auto& [a, b, c] : mesh.faces) {
    edges.emplace_back(a, b);
    edges.emplace_back(b, c);
    edges.emplace_back(c, a);
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

}  // namespace

MeshMeasures measures_of(const TriangleMesh& mesh) {
  MeshMeasures measures;
  for (const auto& face : mesh.faces) {
    const std::uint32_t last = *std::max_element(face.begin(), face.end());
    if (last >= mesh.vertices.size())
      throw Error(ErrorCode::kInconsistent,
                  "mesh: a face has vertex " + std::to_string(last) + ", expected less than " +
                      std::to_string(mesh.vertices.size()),
                  "write the mesh again");
    const Vec3<double> a = mesh.at(face[0]);
    const Vec3<double> b = mesh.at(face[1]);
    const Vec3<double> c = mesh.at(face[2]);
    measures.volume += dot(a, cross(b, c)) / 6;
    measures.area += length(cross(b - a, c - a)) / 2;
  }
  const std::vector<Edge> edges = directed_edges(mesh);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i > 0 && edges[i] == edges[i - 1]) {
      if (i < 2 || edges[i] != edges[i - 2]) ++measures.non_manifold_edges;
      continue;
    }
    const Edge other{edges[i].second, edges[i].first};
    if (!std::binary_search(edges.begin(), edges.end(), other)) ++measures.border_edges;
  }
  return measures;
}

}  // namespace ngs::mesh
