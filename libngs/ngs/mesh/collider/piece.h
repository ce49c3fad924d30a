#pragma once
// Pieces of a solid between planes: their surface, the cells of a lattice that they fill, and their convex hull.
#include <array>
#include <unordered_map>
#include <vector>

#include "ngs/mesh/collider/convex_hull.h"
#include "ngs/mesh/collider/exact_grid.h"

namespace ngs::mesh {

// Parts of parallel rays inside closed meshes: ray (i, j) runs along +z at x, y = (i, j) pitch + pitch / 2, grid steps.

struct RaySpan {
  std::int32_t i, j;
  double low, high;                   ///< z, grid steps
  std::uint32_t low_face, high_face;  ///< rows of the mesh's faces
};

/// A closed mesh on the grid.
struct GridMesh {
  std::vector<GridPoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// Sorted by i, j, z. A ray through a vertex or along an edge is counted for one of the faces there. A place is inside
/// if the ray has entered through more faces than it has left, so solids may overlap.
std::vector<RaySpan> spans_inside(const GridMesh& mesh, std::int64_t pitch);

/// Volumes in grid steps^3, integrated along rays.
struct Difference {
  double in_mesh_only = 0;
  double in_parts_only = 0;
  std::vector<GridPoint> outside;  ///< of each stretch of a ray in parts only: both ends and the middle
};
/// Between the mesh and the union of the parts.
Difference difference_of(const GridMesh& mesh, const std::vector<GridMesh>& parts, std::int64_t pitch);

inline constexpr std::uint32_t kNoRow = ~std::uint32_t(0);

/// The cells of a cubic lattice that a solid reaches.
class CellLattice {
 public:
  /// `pitch`: side of a cell, grid steps, a multiple of kRaysPerSide. The shares are exact along z and of
  /// kRaysPerSide^2 samples across.
  CellLattice(const GridMesh& solid, std::int64_t pitch);
  static constexpr std::int64_t kRaysPerSide = 3;

  struct Cell {
    std::array<std::int32_t, 3> place;  // along x, y, z
    double share = 0;                   // of the cell's volume in the solid, (0, 1]
    std::array<std::uint32_t, 3> next;  // rows of the cells behind it along x, y, z, or kNoRow
  };
  const std::vector<Cell>& cells() const { return cells_; }
  std::int64_t pitch() const { return pitch_; }
  double cell_volume() const { return double(pitch_) * double(pitch_) * double(pitch_); }
  /// The middle of a cell, rounded down.
  GridPoint middle(std::uint32_t row) const;
  /// The cell around the point, or, if the solid does not reach it, the fullest one next to it, or kNoRow.
  std::uint32_t near(GridPoint p) const;

 private:
  std::uint32_t row_at(std::int64_t x, std::int64_t y, std::int64_t z) const;

  std::int64_t pitch_;
  std::vector<Cell> cells_;
  std::unordered_map<std::uint64_t, std::uint32_t> rows_;
};

/// The points p with dot(normal, p) = offset, exact for |normal| below 2^12.
struct CutPlane {
  Vec3<std::int64_t> normal;
  std::int64_t offset;
};

struct Piece {
  struct Point {
    GridPoint place;
    std::uint32_t cell;  // CellLattice::near
  };
  struct Filled {
    std::uint32_t cell;
    double share;  // of the cell's volume
  };
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 3>> surface;  ///< rows of `points`; without the faces in the planes of the cuts
  std::vector<Filled> cells;                          ///< by ascending row
  ConvexHull hull;                                    ///< of `points` and the middles of full cells
  double volume = 0;                                  ///< of the filled cells, grid steps^3

  /// The volume that the hull adds to the piece.
  double outside() const { return hull.volume > volume ? hull.volume - volume : 0; }
};

/// The connected pieces of the solid, largest first. All but the largest are dropped if smaller than half a cell.
std::vector<Piece> pieces_of(const GridMesh& solid, const CellLattice& lattice);
/// The connected pieces on both sides of the plane, with the same rule.
std::vector<Piece> split(const Piece& piece, const CutPlane& plane, const CellLattice& lattice);
/// The area of the section of the piece by the plane, by the cells on it, grid steps^2.
double section_area(const Piece& piece, const CutPlane& plane, const CellLattice& lattice);

}  // namespace ngs::mesh
