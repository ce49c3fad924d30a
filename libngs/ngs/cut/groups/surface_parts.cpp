#include "ngs/cut/groups/surface_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

#include "ngs/math/median.h"
#include "ngs/math/union_find.h"
#include "ngs/math/vectors.h"

namespace ngs {
namespace {

using V = Vec3<double>;
using Cells = std::vector<std::uint32_t>;

constexpr double kConcave = 0.08;      // minimum bend of a crease, rad per side of a cell
constexpr double kSlightBend = 0.01;   // the same where the colours differ by kContrast
constexpr double kContrast = 0.2;      // diagonal of the box around the colours of a cell and its neighbours
constexpr double kFacing = 0.5;        // least length of the mean normal of a cell with one side
constexpr double kNoNormal = 0.3;      // length of a mean normal without a direction
constexpr std::size_t kMinPiece = 40;  // cells
constexpr double kAlike = 0.5;         // minimum overlap of the colour histograms of two joined regions
constexpr double kOneNormal = 0.6;     // minimum share of a flat region's cells with its mean normal
constexpr double kSameNormal = 0.8;    // cosine
constexpr double kRoomExtent = 0.5;    // minimum extent of floor and walls, relative to the model
constexpr double kWallExtent = 0.1;    // minimum extent of a wall, relative to the model
constexpr double kBehindWall = 0.01;   // maximum share of all cells behind a wall
constexpr double kWallDepth = 0.05;    // maximum depth of a wall's inner half, relative to the model's extent
constexpr std::size_t kMaxParts = 1000;

/// Colour histogram of 8 x 8 x 8 bins; a colour is distributed over the nearest bins with trilinear weights.
struct Colours {
  static constexpr int kBins = 8;
  std::array<float, kBins * kBins * kBins> weight{};
  float sum = 0;

  void add(V colour) {
    int low[3];
    double share[3];
    const double value[3] = {colour.x, colour.y, colour.z};
    for (int c = 0; c < 3; ++c) {
      const double at = std::min(std::max(value[c] * kBins - 0.5, 0.0), kBins - 1.001);
      low[c] = int(at);
      share[c] = at - low[c];
    }
    for (int k = 0; k < 8; ++k) {
      double w = 1;
      int bin = 0;
      for (int c = 0; c < 3; ++c) {
        w *= k >> c & 1 ? share[c] : 1 - share[c];
        bin = bin * kBins + low[c] + (k >> c & 1);
      }
      weight[std::size_t(bin)] += float(w);
    }
    sum += 1;
  }
  void add(const Colours& other) {
    for (std::size_t k = 0; k < weight.size(); ++k) weight[k] += other.weight[k];
    sum += other.sum;
  }
  double overlap(const Colours& other) const {
    double common = 0;
    for (std::size_t k = 0; k < weight.size(); ++k)
      common += double(std::min(weight[k] / sum, other.weight[k] / other.sum));
    return common;
  }
};

class Divider {
 public:
  Divider(const SurfaceCells& cells, V up) : cells_(cells), up_(up), region_(cells.count()) {}

  SurfaceParts divided() {
    SurfaceParts out{0, std::vector<std::uint16_t>(cells_.count())};
    if (cells_.count() == 0) return out;
    find_regions();
    grow();
    std::vector<Cells> pieces = merged();
    remove_room(pieces);
    std::ranges::stable_sort(pieces, [](const Cells& a, const Cells& b) { return a.size() > b.size(); });
    out.parts = int(std::min(pieces.size(), kMaxParts));
    for (int k = 0; k < out.parts; ++k)
      for (const std::uint32_t i : pieces[std::size_t(k)]) out.part[i] = std::uint16_t(k + 1);
    return out;
  }

 private:
  std::span<const std::uint32_t> neighbours(std::size_t i) const {
    return std::span(cells_.neighbour).subspan(cells_.first_of[i], cells_.first_of[i + 1] - cells_.first_of[i]);
  }

  /// Bend of the surface at a cell: mean turn of the normals, rad per side of a cell; convex > 0, concave < 0.
  double bend(std::size_t i) const {
    const auto has_normal = [&](std::size_t k) { return length(cells_.normal[k]) > kNoNormal; };
    double turn = 0, square = 0;
    if (!has_normal(i)) return 0;
    for (const std::uint32_t j : neighbours(i)) {
      if (!has_normal(j)) continue;
      const V d = cells_.position[j] - cells_.position[i];
      turn += dot(unit(cells_.normal[j]) - unit(cells_.normal[i]), d);
      square += dot(d, d);
    }
    return square > 0 ? cells_.side * turn / square : 0;
  }

  /// [cells] 1: neither the cell nor a neighbour lies on a crease.
  std::vector<std::uint8_t> open_cells() const {
    std::vector<double> bends(cells_.count());
    std::vector<std::uint8_t> open(bends.size());
    for (std::size_t i = 0; i < bends.size(); ++i) bends[i] = bend(i);
    for (std::size_t i = 0; i < bends.size(); ++i) {
      double least = bends[i];
      V low = cells_.colour[i], high = low;
      for (const std::uint32_t j : neighbours(i)) {
        least = std::min(least, bends[j]);
        const V& c = cells_.colour[j];
        low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
        high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
      }
      const double deep = length(high - low) > kContrast ? kSlightBend : kConcave;
      open[i] = least >= -deep && length(cells_.normal[i]) > kFacing;
    }
    return open;
  }

  /// Connected regions between creases, numbered from 1; smaller ones than kMinPiece are not numbered.
  void find_regions() {
    std::vector<std::uint8_t> open = open_cells();
    Cells piece;
    for (std::size_t first = 0; first < open.size(); ++first) {
      if (!open[first]) continue;
      piece.assign(1, std::uint32_t(first));
      open[first] = 0;
      for (std::size_t k = 0; k < piece.size(); ++k)
        for (const std::uint32_t next : neighbours(piece[k]))
          if (open[next]) {
            open[next] = 0;
            piece.push_back(next);
          }
      if (piece.size() < kMinPiece) continue;
      ++regions_;
      for (const std::uint32_t i : piece) region_[i] = regions_;
    }
  }

  /// The most frequent region of the neighbours, in a tie the lowest number; 0: no neighbour has a region.
  std::uint32_t region_around(std::size_t i) const {
    Cells around;
    for (const std::uint32_t j : neighbours(i))
      if (region_[j] != 0) around.push_back(region_[j]);
    std::ranges::sort(around);
    std::uint32_t found = 0;
    std::ptrdiff_t most = 0;
    for (auto at = around.begin(); at != around.end();) {
      const auto end = std::upper_bound(at, around.end(), *at);
      if (end - at > most) {
        most = end - at;
        found = *at;
      }
      at = end;
    }
    return found;
  }

  /// Grows the regions outwards: each other cell gets the most frequent region of its neighbours.
  void grow() {
    for (bool grown = true; grown;) {
      grown = false;
      std::vector<std::uint32_t> next = region_;
      for (std::size_t i = 0; i < region_.size(); ++i) {
        if (region_[i] != 0) continue;
        next[i] = region_around(i);
        grown |= next[i] != 0;
      }
      region_ = std::move(next);
    }
  }

  /// Pairs of regions that touch, ascending.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> contacts() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (std::size_t i = 0; i < region_.size(); ++i)
      for (const std::uint32_t j : neighbours(i))
        if (region_[i] != 0 && region_[i] < region_[j]) found.emplace_back(region_[i], region_[j]);
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Joins regions that touch and have the same colours, the most similar ones first.
  std::vector<Cells> merged() {
    std::vector<Colours> colours(regions_ + 1);
    for (std::size_t i = 0; i < region_.size(); ++i) colours[region_[i]].add(cells_.colour[i]);
    const auto pairs = contacts();
    std::vector<double> overlap;
    for (const auto& [a, b] : pairs) overlap.push_back(colours[a].overlap(colours[b]));
    UnionFind joined(regions_ + 1);
    while (!pairs.empty()) {
      const auto best = std::size_t(std::ranges::max_element(overlap) - overlap.begin());
      if (overlap[best] < kAlike) break;
      const std::uint32_t a = joined.root(pairs[best].first), b = joined.root(pairs[best].second);
      joined.join(a, b);
      const std::uint32_t root = joined.root(a);
      colours[root].add(colours[a == root ? b : a]);
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        const std::uint32_t c = joined.root(pairs[k].first), d = joined.root(pairs[k].second);
        if (c == d)
          overlap[k] = 0;
        else if (c == root || d == root)
          overlap[k] = colours[c].overlap(colours[d]);
      }
    }
    std::vector<Cells> pieces(regions_ + 1);
    for (std::size_t i = 0; i < region_.size(); ++i)
      if (region_[i] != 0) pieces[joined.root(region_[i])].push_back(std::uint32_t(i));
    std::erase_if(pieces, [](const Cells& piece) { return piece.empty(); });
    return pieces;
  }

  /// The diagonal of the box around the cells, at right angles to up.
  double extent(const Cells& of) const {
    const V axes[2] = {orbit::perpendicular(up_), cross(up_, orbit::perpendicular(up_))};
    double sum = 0;
    for (const V& axis : axes) {
      const std::vector<double> along = heights(of, axis);
      const auto [low, high] = std::ranges::minmax(along);
      sum += (high - low) * (high - low);
    }
    return std::sqrt(sum);
  }

  std::vector<double> heights(const Cells& of, V axis) const {
    std::vector<double> along;
    for (const std::uint32_t i : of) along.push_back(dot(axis, cells_.position[i]));
    return along;
  }

  V mean_normal(const Cells& piece) const {
    V sum{0, 0, 0};
    for (const std::uint32_t i : piece) sum = sum + cells_.normal[i];
    return length(sum) > 0 ? unit(sum) : sum;
  }

  /// Whether most cells have the same normal: a part of a wall, of the floor, or of a table top.
  bool is_flat(const Cells& piece) const {
    const V mean = mean_normal(piece);
    const auto same =
        std::ranges::count_if(piece, [&](std::uint32_t i) { return dot(cells_.normal[i], mean) > kSameNormal; });
    return double(same) > kOneNormal * double(piece.size());
  }

  /// A wall: pieces whose median position along `out` is at least `from` lie as far out as the wall.
  struct Wall {
    V out{0, 0, 0};
    double from = 0;
  };

  /// Adds the walls of a piece. A wall is a wide set of cells with one horizontal normal and almost no cells behind its
  /// middle. A piece may contain several walls, because adjacent walls of one colour were joined.
  void find_walls(const Cells& piece, double whole, std::vector<Wall>& walls) const {
    constexpr int kDirections = 24;
    if (extent(piece) < kWallExtent * whole) return;
    const V a = orbit::perpendicular(up_), b = cross(up_, a);
    Cells side;
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2 * std::numbers::pi * k / kDirections;
      const V facing = std::cos(angle) * a + std::sin(angle) * b;
      side.clear();
      std::ranges::copy_if(piece, std::back_inserter(side),
                           [&](std::uint32_t i) { return dot(cells_.normal[i], facing) > kSameNormal; });
      if (side.empty() || extent(side) < kWallExtent * whole) continue;
      const V normal = mean_normal(side), out = unit(dot(normal, up_) * up_ - normal);
      const std::vector<double> along = heights(side, out);
      const double middle = upper_median(along), from = quantile(along, 0.05);
      if (middle - from > kWallDepth * whole) continue;
      const auto behind = std::ranges::count_if(cells_.position, [&](const V& p) { return dot(out, p) > middle; });
      if (double(behind) - 0.5 * double(side.size()) <= kBehindWall * double(cells_.count()))
        walls.push_back({out, from});
    }
  }

  /// Removes floor and walls, pieces as far out as a wall, flat pieces, and pieces smaller than kMinPiece.
  void remove_room(std::vector<Cells>& pieces) const {
    Cells all(cells_.count());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::uint32_t(i);
    const double whole = extent(all);
    std::vector<Wall> walls;
    for (const Cells& piece : pieces) find_walls(piece, whole, walls);
    std::erase_if(pieces, [&](const Cells& piece) {
      return piece.size() < kMinPiece || extent(piece) >= kRoomExtent * whole || is_flat(piece) ||
             std::ranges::any_of(walls,
                                 [&](const Wall& wall) { return upper_median(heights(piece, wall.out)) >= wall.from; });
    });
  }

  const SurfaceCells& cells_;
  V up_;
  std::vector<std::uint32_t> region_;  // [cells] 1 .. regions_; 0: none
  std::uint32_t regions_ = 0;
};

}  // namespace

SurfaceParts surface_parts(const SurfaceCells& cells, V up) { return Divider(cells, up).divided(); }

NumberedMasks masks_of_parts(const DepthView& view, const SurfaceCells& cells, const SurfaceParts& parts) {
  NumberedMasks masks{ImageU16(view.depth.width_px, view.depth.height_px, 1, NumberedMasks::kUnknown), parts.parts};
  for (int y = 0; y < view.depth.height_px; ++y)
    for (int x = 0; x < view.depth.width_px; ++x) {
      const std::int64_t cell = view.depth.at(x, y) > 0 ? cells.at(view.point(x, y)) : -1;
      if (cell >= 0) masks.number.at(x, y) = parts.part[std::size_t(cell)];
    }
  return masks;
}

}  // namespace ngs
