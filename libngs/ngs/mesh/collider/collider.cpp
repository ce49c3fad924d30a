#include "ngs/mesh/collider/collider.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/backend/for_each.h"
#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/mesh/collider/convex_hull.h"
#include "ngs/mesh/collider/piece.h"
#include "ngs/mesh/measures.h"
#include "ngs/ops/neighbours/knn.h"

namespace ngs::mesh {
namespace {

using Direction = Vec3<std::int64_t>;

constexpr double kCells = 20000;              // approximate number of lattice cells in the solid
constexpr double kSmallShare = 5e-4;          // share of the volume; a piece whose hull adds less is not cut
constexpr double kMergedShare = 2e-4;         // share of the volume; pieces are merged if their common hull adds less
constexpr std::size_t kCutsPerPart = 2;       // cutting stops at this number of pieces per allowed part
constexpr std::size_t kMergeCorners = 10000;  // no limit in practice
constexpr int kOffsets = 15;                  // candidate planes across the piece, per direction
constexpr int kFinerLevels = 3;               // levels of refinement, each with 1/4 of the previous step
constexpr std::size_t kRefined = 3;           // number of best planes that are refined

constexpr double kSectionWeight = 0.02;

/// The axes, and the principal directions of the piece as multiples of 2^-10.
std::vector<Direction> directions_of(const Piece& piece, const CellLattice& lattice) {
  std::vector<Direction> directions{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto position = [&](std::uint32_t row) {
    const GridPoint p = lattice.middle(row);
    return Eigen::Vector3d{double(p.x), double(p.y), double(p.z)};
  };
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double sum = 0;
  for (const auto& [row, share] : piece.cells) {
    mean += share * position(row);
    sum += share;
  }
  if (!(sum > 0)) return directions;
  mean /= sum;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& [row, share] : piece.cells)
    spread += share * (position(row) - mean) * (position(row) - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d v = 1024 * solver.eigenvectors().col(k);
    directions.push_back({std::llround(v.x()), std::llround(v.y()), std::llround(v.z())});
  }
  return directions;
}

/// A plane across a piece, at a share of its width along a direction.
struct PlaneCandidate {
  std::size_t direction;
  double share;
  double cost = std::numeric_limits<double>::infinity();
};

/// Searches the plane after which the pieces' hulls enclose the least volume outside the solid.
class CutSearch {
 public:
  CutSearch(const Exec& exec, const Piece& piece, const CellLattice& lattice)
      : exec_(exec), piece_(piece), lattice_(lattice), directions_(directions_of(piece, lattice)) {
    for (const Direction& n : directions_) {
      const auto along = [n](const Piece::Point& p) { return dot(n, p.place); };
      const auto [low, high] = std::ranges::minmax_element(piece.points, {}, along);
      low_.push_back(along(*low));
      width_.push_back(along(*high) - along(*low));
    }
  }

  /// The pieces on both sides of the best plane; empty if no plane costs less than the uncut piece.
  std::vector<Piece> best_split() {
    std::vector<PlaneCandidate> candidates;
    for (std::size_t d = 0; d < directions_.size(); ++d)
      for (int k = 1; k <= kOffsets; ++k) candidates.push_back({d, double(k) / (kOffsets + 1)});
    keep_best(candidates);
    double step = 1.0 / (kOffsets + 1);
    for (int level = 0; level < kFinerLevels; ++level) {
      step /= 4;
      std::vector<PlaneCandidate> finer;
      for (const PlaneCandidate& candidate : candidates)
        for (const int k : {-3, -2, -1, 1, 2, 3}) finer.push_back({candidate.direction, candidate.share + k * step});
      finer.insert(finer.end(), candidates.begin(), candidates.end());
      candidates = std::move(finer);
      keep_best(candidates);
    }
    if (candidates.empty() || candidates[0].cost >= piece_.outside()) return {};
    return split(piece_, plane_of(candidates[0]), lattice_);
  }

 private:
  CutPlane plane_of(const PlaneCandidate& c) const {
    return {directions_[c.direction], low_[c.direction] + std::llround(c.share * double(width_[c.direction]))};
  }

  /// Root of the sum of squared excess volumes, which favours even shares, plus a little of the section area. The area
  /// favours a cut across a ring over one along it, although the hulls of both add the same volume.
  double cost_of(const PlaneCandidate& c) const {
    double sum = 0;
    const std::vector<Piece> pieces = split(piece_, plane_of(c), lattice_);
    for (const Piece& piece : pieces) sum += piece.outside() * piece.outside();
    if (pieces.size() < 2) return std::numeric_limits<double>::infinity();
    return std::sqrt(sum) + kSectionWeight * std::cbrt(piece_.volume) * section_area(piece_, plane_of(c), lattice_);
  }

  void keep_best(std::vector<PlaneCandidate>& candidates) const {
    for_each_task(exec_, std::int64_t(candidates.size()), [&](std::int64_t i) {
      PlaneCandidate& candidate = candidates[std::size_t(i)];
      if (!std::isfinite(candidate.cost)) candidate.cost = cost_of(candidate);
    });
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const PlaneCandidate& a, const PlaneCandidate& b) { return a.cost < b.cost; });
    if (candidates.size() > kRefined) candidates.resize(kRefined);
  }

  const Exec& exec_;
  const Piece& piece_;
  const CellLattice& lattice_;
  std::vector<Direction> directions_;
  std::vector<std::int64_t> low_, width_;
};

/// The hull and the volume of a piece, which is all that merging needs.
struct Part {
  ConvexHull hull;
  double volume = 0;
  double outside() const { return std::max(hull.volume - volume, 0.0); }
};

Part merged(const Part& a, const Part& b) {
  std::vector<GridPoint> points = a.hull.vertices;
  points.insert(points.end(), b.hull.vertices.begin(), b.hull.vertices.end());
  return {convex_hull(points, kMergeCorners), a.volume + b.volume};
}

/// Merges the pair whose common hull adds the least volume, while there are too many parts or that volume is small.
class Merger {
 public:
  Merger(const Exec& exec, const std::vector<Piece>& pieces) : exec_(exec) {
    for (const Piece& piece : pieces) parts_.push_back({piece.hull, piece.volume});
    for (std::size_t b = 1; b < parts_.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) pairs_.push_back({a, b});
    alive_.assign(parts_.size(), 1);
    measure(0);
  }

  std::vector<Part> merge(std::size_t max_parts, double max_added_volume) && {
    for (std::size_t count = parts_.size(); count > 1; --count) {
      const Pair best = *std::ranges::min_element(pairs_, {}, &Pair::added);
      if (count <= max_parts && best.added > max_added_volume) break;
      parts_.push_back(merged(parts_[best.a], parts_[best.b]));
      alive_[best.a] = 0;
      alive_[best.b] = 0;
      alive_.push_back(1);
      std::erase_if(pairs_, [this](const Pair& pair) { return !alive_[pair.a] || !alive_[pair.b]; });
      const std::size_t first = pairs_.size();
      for (std::size_t a = 0; a + 1 < parts_.size(); ++a)
        if (alive_[a]) pairs_.push_back({a, parts_.size() - 1});
      measure(first);
    }
    std::vector<Part> result;
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (alive_[i]) result.push_back(std::move(parts_[i]));
    return result;
  }

 private:
  struct Pair {
    std::size_t a, b;
    double added = 0;
  };
  void measure(std::size_t first) {
    for_each_task(exec_, std::int64_t(pairs_.size() - first), [&](std::int64_t k) {
      Pair& pair = pairs_[first + std::size_t(k)];
      const Part& a = parts_[pair.a];
      const Part& b = parts_[pair.b];
      pair.added = merged(a, b).outside() - a.outside() - b.outside();
    });
  }

  const Exec& exec_;
  std::vector<Part> parts_;
  std::vector<Pair> pairs_;
  std::vector<std::uint8_t> alive_;
};

double total_outside(const std::vector<Part>& parts) {
  double sum = 0;
  for (const Part& part : parts) sum += part.outside();
  return sum;
}

/// Approximate convex decomposition: a solid is cut by planes until the hulls of the pieces add little volume, then
/// pieces are merged again (after Mamou and Ghorbel 2009, HACD, and Wei et al. 2022, CoACD).
///
/// Returns at most `parts` (>= 1) hulls that together contain nearly all of the solid; they may overlap. `volume` > 0
/// of the solid, grid steps^3, sets the lattice. Separate components of the solid are merged if there are more of them.
std::vector<ConvexHull> convex_parts(const Exec& exec, const GridMesh& solid, double volume, int parts) {
  const auto max_parts = std::size_t(parts);
  const auto third = std::llround(std::cbrt(volume / kCells) / double(CellLattice::kRaysPerSide));
  const CellLattice lattice(solid, CellLattice::kRaysPerSide * std::max<std::int64_t>(1, third));
  std::vector<Piece> pieces = pieces_of(solid, lattice);
  std::vector<std::uint8_t> done(pieces.size(), 0);
  std::vector<Piece> few = pieces;  // the last state with at most `parts` pieces
  while (parts > 1 && pieces.size() < kCutsPerPart * max_parts) {
    std::size_t next = pieces.size();
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (!done[i] && pieces[i].outside() > kSmallShare * volume &&
          (next == pieces.size() || pieces[i].outside() > pieces[next].outside()))
        next = i;
    if (next == pieces.size()) break;
    std::vector<Piece> halves = CutSearch(exec, pieces[next], lattice).best_split();
    if (halves.empty()) {
      done[next] = 1;
      continue;
    }
    pieces[next] = std::move(halves[0]);
    for (std::size_t i = 1; i < halves.size(); ++i) pieces.push_back(std::move(halves[i]));
    done.resize(pieces.size(), 0);
    if (pieces.size() <= max_parts) few = pieces;
  }
  const double max_added_volume = kMergedShare * volume;
  std::vector<Part> best = Merger(exec, pieces).merge(max_parts, max_added_volume);
  std::vector<Part> direct = Merger(exec, few).merge(max_parts, max_added_volume);
  if (total_outside(direct) < total_outside(best)) best = std::move(direct);
  std::vector<ConvexHull> hulls;
  for (Part& part : best)
    if (!part.hull.faces.empty()) hulls.push_back(std::move(part.hull));
  return hulls;
}

constexpr double kRayCells = 4e5;  // cells of the ray lattice in the mesh; fewer if kMostRaysAcross limits the rays
constexpr double kMostRaysAcross = 450;
constexpr std::size_t kMostPlaces = 100000;  // maximum number of places whose distance to the mesh is measured

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
