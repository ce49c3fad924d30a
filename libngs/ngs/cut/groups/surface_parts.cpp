#include "ngs/cut/groups/surface_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "ngs/math/median.h"
#include "ngs/math/vectors.h"

namespace ngs {
namespace {

using V = Vec3<double>;
using Cells = std::vector<std::uint32_t>;

constexpr double kLevel = 0.8;         // least cosine between the normal of a level cell and up
constexpr double kSlab = 2;            // half thickness of a level surface, sides of a cell
constexpr double kMaxBelow = 0.03;     // share of the cells below a floor
constexpr double kRoomExtent = 0.5;    // least extent of walls, of that of the model
constexpr std::size_t kMinPiece = 25;  // cells
constexpr std::size_t kMinLevel = 60;  // cells of a level surface that carries pieces
constexpr double kOpen = 3;            // cells of such a surface, per cell of it next to what it carries
constexpr double kWallExtent = 0.1;    // least extent of a wall, of that of the model
constexpr double kBehindWall = 0.01;   // share of the cells behind a wall
constexpr double kBump = 0.85;         // share of level cells
constexpr double kWide = 3;      // extent of a surface that is no part of the one piece on it, of that of the piece
constexpr double kSmall = 0.05;  // cells of a piece that does not count, of those of the largest on a surface
constexpr int kFeet = 4;         // cells
constexpr std::size_t kMaxParts = 1000;
constexpr int kTries = 8, kMaxDepth = 24;  // level surfaces of a piece; divisions of a part

struct Plane {
  V normal;
  double offset;
  double height(V p) const { return dot(normal, p) - offset; }
};

class Divider {
 public:
  Divider(const SurfaceCells& cells, V up) : cells_(cells), up_(up), set_(cells.count()), part_(cells.count()) {}

  SurfaceParts divided() {
    Cells all(cells_.count());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::uint32_t(i);
    if (all.empty()) return {0, {}};
    whole_ = extent(all);
    std::vector<Cells> pieces;
    const std::optional<Plane> floor = floor_of(all);
    const bool has_floor = floor.has_value();
    if (has_floor) up_ = floor->normal;
    pieces = has_floor ? carried(all, *floor).pieces : connected(all);
    if (has_floor) remove_room(pieces);
    for (const Cells& piece : pieces)
      if (extent(piece) < kRoomExtent * whole_ && piece.size() >= kMinPiece) found_.push_back(furniture_of(piece));
    std::ranges::stable_sort(found_, [](const Cells& a, const Cells& b) { return a.size() > b.size(); });
    SurfaceParts out{int(std::min(found_.size(), kMaxParts)), std::vector<std::uint16_t>(cells_.count())};
    for (int k = 0; k < out.parts; ++k)
      for (const std::uint32_t i : found_[std::size_t(k)]) out.part[i] = std::uint16_t(k + 1);
    return out;
  }

 private:
  struct Carried {
    std::vector<Cells> pieces;            // above the surface, with at least kMinPiece cells
    std::vector<std::uint32_t> standing;  // of these, on one connected level surface: index + 1, ascending
    Cells rest;                           // the surface, what is below it and around it
  };

  std::span<const std::uint32_t> neighbours(std::uint32_t i) const {
    return std::span(cells_.neighbour).subspan(cells_.first_of[i], cells_.first_of[i + 1] - cells_.first_of[i]);
  }

  bool is_level(std::uint32_t i) const { return dot(cells_.normal[i], up_) > kLevel; }

  /// The diagonal of the box around the cells, at right angles to up.
  double extent(const Cells& of) const {
    const V axes[2] = {orbit::perpendicular(up_), cross(up_, orbit::perpendicular(up_))};
    double sum = 0;
    for (const V& axis : axes) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const std::uint32_t i : of) {
        low = std::min(low, dot(axis, cells_.position[i]));
        high = std::max(high, dot(axis, cells_.position[i]));
      }
      sum += (high - low) * (high - low);
    }
    return std::sqrt(sum);
  }

  /// What lies as far out as a wall does.
  struct Wall {
    V out{0, 0, 0};
    double from = 0;
  };

  /// A piece is a wall if it is wide and nearly nothing lies behind its middle in one level direction.
  std::optional<Wall> wall_of(const Cells& piece) const {
    constexpr int kDirections = 24;
    if (extent(piece) < kWallExtent * whole_) return std::nullopt;
    const V a = orbit::perpendicular(up_), b = cross(up_, a);
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 6.283185307179586 * k / kDirections;
      const V out = std::cos(angle) * a + std::sin(angle) * b;
      const std::vector<double> along = heights(piece, out);
      const double middle = upper_median(along);
      const auto behind = std::ranges::count_if(cells_.position, [&](const V& p) { return dot(out, p) > middle; });
      if (double(behind) - 0.5 * double(piece.size()) <= kBehindWall * double(cells_.count()))
        return Wall{out, quantile(along, 0.05)};
    }
    return std::nullopt;
  }

  std::vector<double> heights(const Cells& of, V axis) const {
    std::vector<double> along;
    for (const std::uint32_t i : of) along.push_back(dot(axis, cells_.position[i]));
    return along;
  }

  /// Removes walls, pieces as far out as a wall, and unevenness of the floor.
  void remove_room(std::vector<Cells>& pieces) const {
    std::vector<Wall> walls;
    for (const Cells& piece : pieces)
      if (const std::optional<Wall> wall = wall_of(piece)) walls.push_back(*wall);
    std::erase_if(pieces, [&](const Cells& piece) {
      return is_bump(piece) || std::ranges::any_of(walls, [&](const Wall& wall) {
               return upper_median(heights(piece, wall.out)) >= wall.from;
             });
    });
  }

  /// Whether a piece is nothing but level cells: unevenness of the floor.
  bool is_bump(const Cells& piece) const {
    const auto level = std::ranges::count_if(piece, [&](std::uint32_t i) { return is_level(i); });
    return double(level) > kBump * double(piece.size());
  }

  /// Connected pieces of the cells, by their first cell.
  std::vector<Cells> connected(const Cells& of) {
    for (const std::uint32_t i : of) set_[i] = 1;
    std::vector<Cells> pieces;
    for (const std::uint32_t first : of) {
      if (!set_[first]) continue;
      Cells piece{first};
      set_[first] = 0;
      for (std::size_t k = 0; k < piece.size(); ++k)
        for (const std::uint32_t next : neighbours(piece[k]))
          if (set_[next]) {
            set_[next] = 0;
            piece.push_back(next);
          }
      pieces.push_back(std::move(piece));
    }
    return pieces;
  }

  /// Heights of the level surfaces of the cells: the fullest bins of two sides, kTries at most.
  std::vector<double> levels(const Cells& of) const {
    std::map<std::int64_t, std::size_t> bins;
    for (const std::uint32_t i : of)
      if (is_level(i)) ++bins[std::int64_t(std::floor(dot(up_, cells_.position[i]) / (2 * cells_.side)))];
    std::vector<std::pair<std::size_t, std::int64_t>> fullest;
    for (const auto& [bin, count] : bins)
      if (2 * count >= kMinLevel) fullest.push_back({count, bin});
    std::ranges::sort(fullest, std::greater());
    std::vector<double> heights;
    for (std::size_t k = 0; k < std::min<std::size_t>(fullest.size(), kTries); ++k)
      heights.push_back((double(fullest[k].second) + 0.5) * 2 * cells_.side);
    return heights;
  }

  /// The least-squares plane through the level cells near a height; the tolerance shrinks from `within` to the slab's.
  Plane fitted(const Cells& of, double height, double within) const {
    Plane plane{up_, height};
    for (int fit = 0; fit < 6; ++fit) {
      const double tolerance = std::max(within / (1 << fit), kSlab) * cells_.side;
      const V a = orbit::perpendicular(plane.normal), b = cross(plane.normal, a);
      V mean{0, 0, 0};
      Cells near;
      for (const std::uint32_t i : of)
        if (is_level(i) && std::abs(plane.height(cells_.position[i])) <= tolerance) {
          near.push_back(i);
          mean = mean + cells_.position[i];
        }
      if (near.size() < 3) return plane;
      mean = (1 / double(near.size())) * mean;
      double aa = 0, ab = 0, bb = 0, ah = 0, bh = 0;  // h = p a + q b
      for (const std::uint32_t i : near) {
        const V d = cells_.position[i] - mean;
        const double x = dot(a, d), y = dot(b, d), h = dot(plane.normal, d);
        aa += x * x;
        ab += x * y;
        bb += y * y;
        ah += x * h;
        bh += y * h;
      }
      const double det = aa * bb - ab * ab;
      if (det > 1e-6 * (aa + bb) * (aa + bb))
        plane.normal = unit(plane.normal - ((bb * ah - ab * bh) / det) * a - ((aa * bh - ab * ah) / det) * b);
      plane.offset = dot(plane.normal, mean);
    }
    return plane;
  }

  std::optional<Plane> floor_of(const Cells& all) const {
    constexpr double kFirstFit = 10;  // sides of a cell
    for (const double height : levels(all)) {
      const Plane plane = fitted(all, height, kFirstFit);
      const auto below = std::ranges::count_if(
          all, [&](std::uint32_t i) { return plane.height(cells_.position[i]) < -2 * kSlab * cells_.side; });
      if (double(below) <= kMaxBelow * double(all.size())) return plane;
    }
    return std::nullopt;
  }

  /// What a level surface carries.
  Carried carried(const Cells& of, const Plane& plane) {
    Cells level, above, around;
    for (const std::uint32_t i : of) {
      const double height = plane.height(cells_.position[i]) / cells_.side;
      (std::abs(height) <= kSlab && is_level(i) ? level : height > 1 ? above : around).push_back(i);
    }
    Carried out;
    for (Cells& piece : connected(above))
      if (piece.size() >= kMinPiece)
        out.pieces.push_back(std::move(piece));
      else
        out.rest.insert(out.rest.end(), piece.begin(), piece.end());
    add_feet(plane, around, out);
    find_support(level, out);
    out.rest.insert(out.rest.end(), level.begin(), level.end());
    std::ranges::sort(out.rest);
    return out;
  }

  /// Gives the pieces the sides of their lower ends, which lie within the slab.
  void add_feet(const Plane& plane, const Cells& around, Carried& out) {
    for (std::size_t k = 0; k < out.pieces.size(); ++k)
      for (const std::uint32_t i : out.pieces[k]) part_[i] = std::uint32_t(k + 1);
    for (const std::uint32_t i : around) set_[i] = std::abs(plane.height(cells_.position[i])) <= kSlab * cells_.side;
    std::vector<std::size_t> first(out.pieces.size());
    for (int step = 0; step < kFeet; ++step)
      for (std::size_t k = 0; k < out.pieces.size(); ++k) {
        Cells& piece = out.pieces[k];
        const std::size_t end = piece.size();
        for (std::size_t n = first[k]; n < end; ++n)
          for (const std::uint32_t next : neighbours(piece[n]))
            if (set_[next]) {
              set_[next] = 0;
              part_[next] = std::uint32_t(k + 1);
              piece.push_back(next);
            }
        first[k] = end;
      }
    for (const std::uint32_t i : around) {
      set_[i] = 0;
      if (part_[i] == 0) out.rest.push_back(i);
    }
  }

  /// Keeps the pieces on the connected level surface that carries most of them, and clears part_.
  void find_support(const Cells& level, Carried& out) {
    std::vector<std::uint32_t> best;
    for (const Cells& surface : connected(level)) {
      std::vector<std::uint32_t> on;
      std::size_t touching = 0;
      for (const std::uint32_t i : surface) {
        bool touches = false;
        for (const std::uint32_t next : neighbours(i))
          if (part_[next] != 0) {
            on.push_back(part_[next]);
            touches = true;
          }
        touching += touches;
      }
      std::ranges::sort(on);
      on.erase(std::unique(on.begin(), on.end()), on.end());
      if (surface.size() < kMinLevel || double(surface.size()) < kOpen * double(touching)) continue;
      if (is_support(surface, on, out.pieces) && on.size() > best.size()) best = on;
    }
    for (const Cells& piece : out.pieces)
      for (const std::uint32_t i : piece) part_[i] = 0;
    out.standing = std::move(best);
  }

  /// Whether a surface with these pieces (index + 1) on it is another thing than they are.
  bool is_support(const Cells& surface, const std::vector<std::uint32_t>& on, const std::vector<Cells>& pieces) const {
    std::size_t largest = 0;
    for (const std::uint32_t k : on) largest = std::max(largest, pieces[k - 1].size());
    const auto counted = std::ranges::count_if(
        on, [&](std::uint32_t k) { return double(pieces[k - 1].size()) >= kSmall * double(largest); });
    return counted >= 2 || (!on.empty() && extent(surface) > kWide * extent(pieces[on[0] - 1]));
  }

  /// Adds what the level surfaces of a piece carry to the parts, and returns the rest: all of it if they carry nothing.
  Cells furniture_of(const Cells& piece, int depth = 0) {
    for (const double height : levels(piece)) {
      Carried on = carried(piece, fitted(piece, height, kSlab));
      if (on.standing.empty() || depth >= kMaxDepth) continue;
      Cells rest = std::move(on.rest);
      for (std::size_t k = 0; k < on.pieces.size(); ++k) {
        Cells remains = on.pieces[k];
        bool is_part = std::ranges::binary_search(on.standing, std::uint32_t(k + 1));
        if (is_part) {
          const std::size_t before = found_.size();
          remains = furniture_of(on.pieces[k], depth + 1);
          is_part = found_.size() == before;  // else it is the upper part of a rack
        }
        if (is_part)
          found_.push_back(std::move(remains));
        else
          rest.insert(rest.end(), remains.begin(), remains.end());
      }
      std::ranges::sort(rest);
      return furniture_of(rest, depth + 1);
    }
    return piece;
  }

  const SurfaceCells& cells_;
  V up_;
  double whole_ = 0;
  std::vector<std::uint8_t> set_;    // [cells] scratch, 0 between calls
  std::vector<std::uint32_t> part_;  // [cells] scratch, 0 between calls
  std::vector<Cells> found_;
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
