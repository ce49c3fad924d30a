#pragma once
// A triangle mesh.
#include <array>
#include <cstdint>
#include <vector>

#include "ngs/math/vec.h"

namespace ngs {

/// Triangles are counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3<float>> vertices;                ///< [V], in the world of the splat
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< [F], rows of `vertices`
  std::vector<Vec3<float>> colours;                 ///< [V], sRGB, 0 to 1; or empty

  Vec3<double> at(std::uint32_t vertex) const {
    const Vec3<float> v = vertices[vertex];
    return {double(v.x), double(v.y), double(v.z)};
  }
};

/// [V] Unit normals of the vertices: the mean of their faces', weighted by area; 0 0 1 for a vertex without faces.
std::vector<Vec3<float>> vertex_normals(const TriangleMesh& mesh);

}  // namespace ngs
