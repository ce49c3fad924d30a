#include "ngs/mesh/collider/convex_parts.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ngs/backend/for_each.h"

namespace ngs::mesh {
namespace {

constexpr double kCells = 20000;             // about as many in the solid
constexpr double kSmallShare = 5e-4;         // of the volume: a piece whose hull adds less is not cut
constexpr double kMergedShare = 2e-4;        // of the volume: pieces are joined if their common hull adds less
constexpr std::size_t kCutsPerPart = 2;      // pieces, per part that is allowed, before pieces are joined
constexpr std::size_t kJoinCorners = 10000;  // no limit in practice
constexpr int kOffsets = 15;                 // of planes across the piece, per direction
constexpr int kFinerLevels = 3;              // each a quarter of the step before
constexpr std::size_t kRefined = 3;          // planes that are refined

constexpr double kSectionWeight = 0.02;

using Direction = Vec3<std::int64_t>;

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
struct Candidate {
  std::size_t direction;
  double share;
  double cost = std::numeric_limits<double>::infinity();
};

/// The search for the plane that leaves the least volume outside.
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

  /// Both sides of the best plane; empty if no plane does better than the piece as it is.
  std::vector<Piece> best_split() {
    std::vector<Candidate> candidates;
    for (std::size_t d = 0; d < directions_.size(); ++d)
      for (int k = 1; k <= kOffsets; ++k) candidates.push_back({d, double(k) / (kOffsets + 1)});
    keep_best(candidates);
    double step = 1.0 / (kOffsets + 1);
    for (int level = 0; level < kFinerLevels; ++level) {
      step /= 4;
      std::vector<Candidate> finer;
      for (const Candidate& candidate : candidates)
        for (const int k : {-3, -2, -1, 1, 2, 3}) finer.push_back({candidate.direction, candidate.share + k * step});
      finer.insert(finer.end(), candidates.begin(), candidates.end());
      candidates = std::move(finer);
      keep_best(candidates);
    }
    if (candidates.empty() || candidates[0].cost >= piece_.outside()) return {};
    return split(piece_, plane_of(candidates[0]), lattice_);
  }

 private:
  CutPlane plane_of(const Candidate& c) const {
    return {directions_[c.direction], low_[c.direction] + std::llround(c.share * double(width_[c.direction]))};
  }

  /// The root of the sum of squares, so that of two cuts with the same sum that with even shares is better, and a
  /// little of the section: a cut across a ring is better than one along it, though the hulls of both add the same.
  double cost_of(const Candidate& c) const {
    double sum = 0;
    const std::vector<Piece> pieces = split(piece_, plane_of(c), lattice_);
    for (const Piece& piece : pieces) sum += piece.outside() * piece.outside();
    if (pieces.size() < 2) return std::numeric_limits<double>::infinity();
    return std::sqrt(sum) + kSectionWeight * std::cbrt(piece_.volume) * section_area(piece_, plane_of(c), lattice_);
  }

  void keep_best(std::vector<Candidate>& candidates) const {
    for_each_task(exec_, std::int64_t(candidates.size()), [&](std::int64_t i) {
      Candidate& candidate = candidates[std::size_t(i)];
      if (!std::isfinite(candidate.cost)) candidate.cost = cost_of(candidate);
    });
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    if (candidates.size() > kRefined) candidates.resize(kRefined);
  }

  const Exec& exec_;
  const Piece& piece_;
  const CellLattice& lattice_;
  std::vector<Direction> directions_;
  std::vector<std::int64_t> low_, width_;
};

/// What remains of a piece for joining.
struct Part {
  ConvexHull hull;
  double volume = 0;
  double outside() const { return std::max(hull.volume - volume, 0.0); }
};

Part joined(const Part& a, const Part& b) {
  std::vector<GridPoint> points = a.hull.vertices;
  points.insert(points.end(), b.hull.vertices.begin(), b.hull.vertices.end());
  return {convex_hull(points, kJoinCorners), a.volume + b.volume};
}

/// Joins pairs, the pair that adds the least volume outside first, while there are too many parts or it adds little.
class Joiner {
 public:
  Joiner(const Exec& exec, const std::vector<Piece>& pieces) : exec_(exec) {
    for (const Piece& piece : pieces) parts_.push_back({piece.hull, piece.volume});
    for (std::size_t b = 1; b < parts_.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) pairs_.push_back({a, b});
    alive_.assign(parts_.size(), 1);
    measure(0);
  }

  std::vector<Part> join(std::size_t most, double little) && {
    for (std::size_t count = parts_.size(); count > 1; --count) {
      const Pair best = *std::ranges::min_element(pairs_, {}, &Pair::added);
      if (count <= most && best.added > little) break;
      parts_.push_back(joined(parts_[best.a], parts_[best.b]));
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
      pair.added = joined(a, b).outside() - a.outside() - b.outside();
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

}  // namespace

std::vector<ConvexHull> convex_parts(const Exec& exec, const GridMesh& solid, double volume, int parts) {
  const auto most = std::size_t(parts);
  const auto third = std::llround(std::cbrt(volume / kCells) / double(CellLattice::kRaysPerSide));
  const CellLattice lattice(solid, CellLattice::kRaysPerSide * std::max<std::int64_t>(1, third));
  std::vector<Piece> pieces = pieces_of(solid, lattice);
  std::vector<std::uint8_t> done(pieces.size(), 0);
  std::vector<Piece> few = pieces;  // the last state with at most `parts` pieces
  while (parts > 1 && pieces.size() < kCutsPerPart * most) {
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
    if (pieces.size() <= most) few = pieces;
  }
  const double little = kMergedShare * volume;
  std::vector<Part> best = Joiner(exec, pieces).join(most, little);
  std::vector<Part> direct = Joiner(exec, few).join(most, little);
  if (total_outside(direct) < total_outside(best)) best = std::move(direct);
  std::vector<ConvexHull> hulls;
  for (Part& part : best)
    if (!part.hull.faces.empty()) hulls.push_back(std::move(part.hull));
  return hulls;
}

}  // namespace ngs::mesh
