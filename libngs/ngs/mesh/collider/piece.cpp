#include "ngs/mesh/collider/piece.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "ngs/math/union_find.h"

namespace ngs::mesh {
namespace {

std::uint64_t key_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  return std::uint64_t(x) << 42 | std::uint64_t(y) << 21 | std::uint64_t(z);
}

/// Intersection of a ray with a face; `change` is +1 where the ray enters the solid.
struct Crossing {
  std::int32_t i, j;
  double z;
  int change;
  std::uint32_t face;
};

std::int64_t place_of(std::int64_t ray, std::int64_t pitch) { return ray * pitch + pitch / 2; }
/// The first ray at or after x.
std::int64_t first_ray(std::int64_t x, std::int64_t pitch) {
  const std::int64_t before = x - pitch / 2;
  return before > 0 ? (before + pitch - 1) / pitch : before / pitch;
}

/// A triangle seen along z, counter-clockwise. A point on an edge belongs to one of the two triangles at that edge.
class ProjectedTriangle {
 public:
  ProjectedTriangle(GridPoint a, GridPoint b, GridPoint c) : corner_{a, b, c} {}
  bool has(std::int64_t x, std::int64_t y) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const GridPoint a = corner_[k], b = corner_[(k + 1) % 3];
      const std::int64_t dx = b.x - a.x, dy = b.y - a.y, side = dx * (y - a.y) - dy * (x - a.x);
      if (side < 0 || (side == 0 && !(dy < 0 || (dy == 0 && dx < 0)))) return false;
    }
    return true;
  }

 private:
  std::array<GridPoint, 3> corner_;
};

void add_crossings(const GridMesh& mesh, std::uint32_t face, std::int64_t pitch, std::vector<Crossing>& out) {
  const GridPoint a = mesh.vertices[mesh.faces[face][0]];
  const GridPoint b = mesh.vertices[mesh.faces[face][1]];
  const GridPoint c = mesh.vertices[mesh.faces[face][2]];
  const Vec3<std::int64_t> n = cross(b - a, c - a);
  if (n.z == 0) return;
  const ProjectedTriangle triangle = n.z > 0 ? ProjectedTriangle(a, b, c) : ProjectedTriangle(a, c, b);
  const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
  const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
  for (std::int64_t j = first_ray(low_y, pitch); place_of(j, pitch) <= high_y; ++j)
    for (std::int64_t i = first_ray(low_x, pitch); place_of(i, pitch) <= high_x; ++i) {
      const std::int64_t x = place_of(i, pitch);
      const std::int64_t y = place_of(j, pitch);
      if (!triangle.has(x, y)) continue;
      const std::int64_t rise = n.x * (x - a.x) + n.y * (y - a.y);
      out.push_back(
          {std::int32_t(i), std::int32_t(j), double(a.z) - double(rise) / double(n.z), n.z < 0 ? 1 : -1, face});
    }
}

std::vector<Crossing> sorted_crossings(const GridMesh& mesh, std::int64_t pitch) {
  std::vector<Crossing> crossings;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) add_crossings(mesh, f, pitch, crossings);
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::tuple(a.i, a.j, a.z, -a.change, a.face) < std::tuple(b.i, b.j, b.z, -b.change, b.face);
  });
  return crossings;
}

/// Start or end of a span inside the mesh or inside a part.
struct Event {
  std::int32_t i, j;
  double z;
  bool of_part;
  int change;
};

using Index = std::uint32_t;

/// Vertices of the hulls that the search compares; the written hulls may have fewer.
constexpr std::size_t kHullCorners = 128;
constexpr double kCrumb = 0.5;           // cells; smaller pieces are dropped
constexpr double kLeastShare = 1e-9;     // share of a cell; a smaller one counts as empty
constexpr double kFullShare = 1 - 1e-9;  // share of a cell from which the cell counts as full

/// Splits one side into connected pieces. Connected are faces with common points, adjacent cells, a point and its cell.
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

/// Height of a cell's centre above the plane, scaled so that the plane only touches the cell at 0.5.
double height_in_cells(Index cell, const CutPlane& plane, const CellLattice& lattice) {
  const auto& n = plane.normal;
  const std::int64_t across = (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * lattice.pitch();
  return double(dot(n, lattice.middle(cell)) - plane.offset) / double(across);
}

/// Cuts a piece by a plane; the new points on it are shared by the neighbours of an edge.
class PlaneClipper {
 public:
  PlaneClipper(const Piece& piece, const CutPlane& plane, const CellLattice& lattice)
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
    bool is_beyond = false;  // some corner is strictly on this side; a face in the plane is dropped
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

CellLattice::CellLattice(const GridMesh& solid, std::int64_t pitch) : pitch_(pitch) {
  constexpr std::int64_t kSide = kRaysPerSide;
  for (const RaySpan& span : spans_inside(solid, pitch / kSide)) {
    const auto last = std::int64_t(std::floor(span.high / double(pitch)));
    for (auto z = std::int64_t(std::floor(span.low / double(pitch))); z <= last; ++z) {
      const double low = std::max(span.low, double(z * pitch));
      const double high = std::min(span.high, double((z + 1) * pitch));
      if (!(high > low)) continue;
      const std::int64_t x = span.i / kSide;
      const std::int64_t y = span.j / kSide;
      const auto [row, is_new] = rows_.emplace(key_of(x, y, z), std::uint32_t(cells_.size()));
      if (is_new) cells_.push_back({{std::int32_t(x), std::int32_t(y), std::int32_t(z)}, 0, {}});
      cells_[row->second].share += (high - low) / double(pitch * kSide * kSide);
    }
  }
  for (Cell& cell : cells_) {
    const auto [x, y, z] = cell.place;
    cell.next = {row_at(x + 1, y, z), row_at(x, y + 1, z), row_at(x, y, z + 1)};
  }
}

std::uint32_t CellLattice::row_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
  if (x < 0 || y < 0 || z < 0) return kNoRow;
  const auto found = rows_.find(key_of(x, y, z));
  return found == rows_.end() ? kNoRow : found->second;
}

GridPoint CellLattice::middle(std::uint32_t row) const {
  const auto [x, y, z] = cells_[row].place;
  return {x * pitch_ + pitch_ / 2, y * pitch_ + pitch_ / 2, z * pitch_ + pitch_ / 2};
}

std::uint32_t CellLattice::near(GridPoint p) const {
  const std::int64_t x = p.x / pitch_;
  const std::int64_t y = p.y / pitch_;
  const std::int64_t z = p.z / pitch_;
  std::uint32_t best = row_at(x, y, z);
  if (best != kNoRow) return best;
  for (std::int64_t k = 0; k < 27; ++k) {
    const std::uint32_t row = row_at(x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1);
    if (row != kNoRow && (best == kNoRow || cells_[row].share > cells_[best].share)) best = row;
  }
  return best;
}

std::vector<RaySpan> spans_inside(const GridMesh& mesh, std::int64_t pitch) {
  std::vector<RaySpan> spans;
  int depth = 0;
  const Crossing* entry = nullptr;
  const std::vector<Crossing> crossings = sorted_crossings(mesh, pitch);
  for (const Crossing& at : crossings) {
    depth += at.change;
    if (depth == 1 && at.change == 1) entry = &at;
    if (depth == 0 && at.change == -1) spans.push_back({at.i, at.j, entry->z, at.z, entry->face, at.face});
  }
  return spans;
}

Difference difference_of(const GridMesh& mesh, const std::vector<GridMesh>& parts, std::int64_t pitch) {
  std::vector<Event> events;
  const auto add = [&events, pitch](const GridMesh& solid, bool of_part) {
    for (const RaySpan& span : spans_inside(solid, pitch)) {
      events.push_back({span.i, span.j, span.low, of_part, 1});
      events.push_back({span.i, span.j, span.high, of_part, -1});
    }
  };
  add(mesh, false);
  for (const GridMesh& part : parts) add(part, true);
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
    return std::tuple(a.i, a.j, a.z) < std::tuple(b.i, b.j, b.z);
  });
  Difference found;
  const double area = double(pitch) * double(pitch);
  int in_mesh = 0;
  int in_parts = 0;
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& at = events[k];
    if (in_mesh > 0 && in_parts == 0) found.in_mesh_only += area * (at.z - events[k - 1].z);
    if (in_parts > 0 && in_mesh == 0 && at.z > events[k - 1].z) {
      const double low = events[k - 1].z;
      found.in_parts_only += area * (at.z - low);
      for (const double z : {low, (low + at.z) / 2, at.z})
        found.outside.push_back({place_of(at.i, pitch), place_of(at.j, pitch), std::llround(z)});
    }
    (at.of_part ? in_parts : in_mesh) += at.change;
  }
  return found;
}

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
  PlaneClipper clipper(piece, plane, lattice);
  for (const int sign : {1, -1}) Connector(clipper.side(sign), lattice).append_to(pieces);
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
