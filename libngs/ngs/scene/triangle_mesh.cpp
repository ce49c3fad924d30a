#include "ngs/scene/triangle_mesh.h"

namespace ngs {

std::vector<Vec3<float>> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3<double>> sum(mesh.vertices.size(), Vec3<double>{0, 0, 0});
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3<double> normal = cross(mesh.at(b) - mesh.at(a), mesh.at(c) - mesh.at(a));
    for (const std::uint32_t v : {a, b, c}) sum[v] = sum[v] + normal;
  }
  std::vector<Vec3<float>> normals;
  for (const Vec3<double> s : sum) {
    const Vec3<double> n = unit(s);
    normals.push_back({float(n.x), float(n.y), float(n.z)});
  }
  return normals;
}

}  // namespace ngs
