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
};

}  // namespace ngs
