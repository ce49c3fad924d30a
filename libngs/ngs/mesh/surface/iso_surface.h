#pragma once
// The surface where a function of space is 0, as a closed triangle mesh (marching cubes over sparse blocks).
//
// Every cell's polygons are traced along its faces; a face with four crossings separates its two inside corners, the
// same way in both cells that share it. Therefore each arc on a face belongs to exactly two polygons: the mesh is
// watertight and 2-manifold. A polygon that crosses one face twice is filled from its centre, all others as a fan, so
// that no two polygons share a diagonal.
#include <cstddef>
#include <functional>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/triangle_mesh.h"

namespace ngs::mesh {

// The connected pieces of a closed mesh.

struct PieceCounts {
  std::size_t kept = 0, crumbs = 0, cavities = 0;
};
/// Removes crumbs, pieces with less than `least_share` of the area of the largest one, and cavities, closed pieces
/// whose faces point inwards, and the vertices of no face. The order of the rest is kept.
PieceCounts keep_pieces(double least_share, TriangleMesh& mesh);

/// Cells of a block along an axis.
inline constexpr int kBlockCells = 8;

/// A regular grid of samples: sample (x, y, z) lies at low + cell (x, y, z).
struct SampleGrid {
  Vec3<double> low{0, 0, 0};
  double cell = 1;                     // world, > 0
  std::array<int, 3> blocks{1, 1, 1};  // along each axis; kBlockCells cells each

  Vec3<double> at(int x, int y, int z) const { return low + cell * Vec3<double>{double(x), double(y), double(z)}; }
  std::size_t block_count() const { return std::size_t(blocks[0]) * std::size_t(blocks[1]) * std::size_t(blocks[2]); }
};

/// Fills the samples of a block. `low`: its first sample; values [9, 9, 9] z, y, x, negative inside.
using BlockValues = std::function<void(std::array<int, 3> low, std::vector<float>& values)>;

/// The surface through `seeds` (numbers of blocks, x fastest) and all blocks that it continues into; other blocks are
/// not sampled. `values` must be a function of the place: neighbouring blocks share samples. Samples on the border of
/// the grid and NaN count as outside. Faces are counter-clockwise seen from outside. Empty if no sample is inside. The
/// result does not depend on exec.threads.
TriangleMesh iso_surface(const Exec& exec, const SampleGrid& grid, const std::vector<std::uint32_t>& seeds,
                         const BlockValues& values);

}  // namespace ngs::mesh
