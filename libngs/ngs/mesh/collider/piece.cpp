#include "ngs/mesh/collider/piece.h"

#include <algorithm>
#include <cmath>

#include "ngs/math/union_find.h"

namespace ngs::mesh {
namespace {

using Index = std::uint32_t;

/// Corners of the hulls that are compared; the hulls that are written may have fewer.
constexpr std::size_t kHullCorners = 128;
constexpr double kCrumb = 0.5;           // cells
constexpr double kLeastShare = 1e-9;     // of a cell: less is nothing
constexpr double kFullShare = 1 - 1e-9;  // of a cell

/// Splits what is on one side into connected pieces: by common points, by neighbouring cells, and a point with its
/// cell.
class Connector {
 public:
  Connector(const Piece& all, const CellLattice& lattice)
      : all_(all), sets_(all.points.size() + all.cells.size()), node_of_cell_(lattice.cells().size(), kNoRow) {
    for (Index k = 0; k < all.cells.size(); ++k) node_of_cell_[all.cells[k].cell] = cell_node(k);
    for (const auto& [a, b, c] : all.surface) {
      sets_.join(a, b);
      sets_.join(a, c);
      for (const Index corner : {a, b, c}) join_cell(corner, all.points[corner].cell);
    }
    for (Index k = 0; k < all.cells.size(); ++k)
      for (const Index row : lattice.cells()[all.cells[k].cell].next) join_cell(cell_node(k), row);
  }

  void append_to(std::vector<Piece>& pieces) {
    std::vector<Index> piece_of_root(all_.points.size() + all_.cells.size(), kNoRow);
    const auto piece_of = [&](Index node) -> Piece& {
      Index& piece = piece_of_root[sets_.root(node)];
      if (piece == kNoRow) {
        piece = Index(pieces.size());
        pieces.emplace_back();
      }
      return pieces[piece];
    };
    std::vector<Index> row(all_.points.size(), kNoRow);
    for (std::array<Index, 3> face : all_.surface) {
      Piece& piece = piece_of(face[0]);
      for (Index& corner : face) {
        if (row[corner] == kNoRow) {
          row[corner] = Index(piece.points.size());
          piece.points.push_back(all_.points[corner]);
        }
        corner = row[corner];
      }
      piece.surface.push_back(face);
    }
    for (Index k = 0; k < all_.cells.size(); ++k) piece_of(cell_node(k)).cells.push_back(all_.cells[k]);
  }

 private:
  Index cell_node(Index k) const { return Index(all_.points.size() + k); }
  void join_cell(Index node, Index row) {
    if (row != kNoRow && node_of_cell_[row] != kNoRow) sets_.join(node, node_of_cell_[row]);
  }

  const Piece& all_;
  UnionFind sets_;
  std::vector<Index> node_of_cell_;
};

/// Measures the pieces, leaves out crumbs and sorts the others.
std::vector<Piece> measured(std::vector<Piece> pieces, const CellLattice& lattice) {
  for (Piece& piece : pieces) {
    for (const Piece::Filled& filled : piece.cells) piece.volume += filled.share;
    piece.volume *= lattice.cell_volume();
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.volume > b.volume; });
  while (pieces.size() > 1 && pieces.back().volume < kCrumb * lattice.cell_volume()) pieces.pop_back();
  for (Piece& piece : pieces) {
    std::vector<GridPoint> points;
    for (const Piece::Point& p : piece.points) points.push_back(p.place);
    for (const Piece::Filled& filled : piece.cells)
      if (filled.share >= kFullShare) points.push_back(lattice.middle(filled.cell));
    piece.hull = convex_hull(points, kHullCorners);
  }
  return pieces;
}

/// Of a cell's middle above the plane: 0.5 where the plane leaves the cell.
double height_in_cells(Index cell, const CutPlane& plane, const CellLattice& lattice) {
  const auto& n = plane.normal;
  const std::int64_t across = (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * lattice.pitch();
  return double(dot(n, lattice.middle(cell)) - plane.offset) / double(across);
}

/// Cuts a piece by a plane; the new points on it are shared by the neighbours of an edge.
class Knife {
 public:
  Knife(const Piece& piece, const CutPlane& plane, const CellLattice& lattice)
      : piece_(piece), plane_(plane), lattice_(lattice), points_(piece.points) {
    for (const Piece::Point& p : piece.points) height_.push_back(dot(plane.normal, p.place) - plane.offset);
  }

  /// The part of the piece where sign x height >= 0.
  Piece side(int sign) {
    Piece half;
    for (const auto& face : piece_.surface) clip(face, sign, half.surface);
    half.points = points_;
    for (const Piece::Filled& filled : piece_.cells) {
      const double in_front = std::clamp(0.5 + height_in_cells(filled.cell, plane_, lattice_), 0.0, 1.0);
      const double share = filled.share * (sign > 0 ? in_front : 1 - in_front);
      if (share > kLeastShare) half.cells.push_back({filled.cell, share});
    }
    return half;
  }

 private:
  void clip(const std::array<Index, 3>& face, int sign, std::vector<std::array<Index, 3>>& out) {
    std::array<Index, 4> polygon;
    std::size_t corners = 0;
    bool is_beyond = false;  // a face in the plane is a face of the cut
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = face[k];
      const Index b = face[(k + 1) % 3];
      const std::int64_t height_a = sign * height_[a];
      const std::int64_t height_b = sign * height_[b];
      if (height_a > 0) is_beyond = true;
      if (height_a >= 0) polygon[corners++] = a;
      if ((height_a > 0 && height_b < 0) || (height_a < 0 && height_b > 0)) polygon[corners++] = point_between(a, b);
    }
    for (std::size_t k = 2; is_beyond && k < corners; ++k) out.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }

  Index point_between(Index a, Index b) {
    if (a > b) std::swap(a, b);
    const auto [entry, is_new] = between_.emplace(std::uint64_t(a) << 32 | b, Index(points_.size()));
    if (is_new) {
      const double t = double(height_[a]) / double(height_[a] - height_[b]);
      const GridPoint from = points_[a].place;
      const GridPoint step = points_[b].place - from;
      const GridPoint place{from.x + std::llround(t * double(step.x)), from.y + std::llround(t * double(step.y)),
                            from.z + std::llround(t * double(step.z))};
      points_.push_back({place, lattice_.near(place)});
    }
    return entry->second;
  }

  const Piece& piece_;
  const CutPlane& plane_;
  const CellLattice& lattice_;
  std::vector<Piece::Point> points_;
  std::vector<std::int64_t> height_;
  std::unordered_map<std::uint64_t, Index> between_;
};

}  // namespace

std::vector<Piece> pieces_of(const GridMesh& solid, const CellLattice& lattice) {
  Piece all;
  for (const GridPoint& p : solid.vertices) all.points.push_back({p, lattice.near(p)});
  all.surface = solid.faces;
  for (Index i = 0; i < lattice.cells().size(); ++i) all.cells.push_back({i, lattice.cells()[i].share});
  std::vector<Piece> pieces;
  Connector(all, lattice).append_to(pieces);
  return measured(std::move(pieces), lattice);
}

std::vector<Piece> split(const Piece& piece, const CutPlane& plane, const CellLattice& lattice) {
  std::vector<Piece> pieces;
  Knife knife(piece, plane, lattice);
  for (const int sign : {1, -1}) Connector(knife.side(sign), lattice).append_to(pieces);
  return measured(std::move(pieces), lattice);
}

double section_area(const Piece& piece, const CutPlane& plane, const CellLattice& lattice) {
  double sum = 0;
  for (const Piece::Filled& filled : piece.cells)
    if (std::abs(height_in_cells(filled.cell, plane, lattice)) < 0.5) sum += filled.share;
  const auto& n = plane.normal;
  const double thickness =
      double(std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) / length(to_double(n));  // of the layer of cells
  return sum * double(lattice.pitch() * lattice.pitch()) / thickness;
}

}  // namespace ngs::mesh
