#include "ngs/mesh/collider/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace ngs::mesh {
namespace {

constexpr std::size_t kFaceCorners = 64;  // vertices of the coarser hull whose faces give the directions of the box

OrientedBox box_along(const ConvexHull& hull, const std::array<Vec3<double>, 3>& axes) {
  OrientedBox box{{}, axes, {}};
  std::array<double, 3> half{};
  for (std::size_t k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const GridPoint& p : hull.vertices) {
      low = std::min(low, dot(axes[k], to_double(p)));
      high = std::max(high, dot(axes[k], to_double(p)));
    }
    half[k] = (high - low) / 2;
    box.centre = box.centre + ((low + high) / 2) * axes[k];
  }
  box.half = {half[0], half[1], half[2]};
  return box;
}

double volume_of(const OrientedBox& box) { return 8 * box.half.x * box.half.y * box.half.z; }

using Index = std::uint32_t;
using Direction = Vec3<std::int64_t>;

/// A face of the current hull, and the points in front of it that are assigned to it.
struct Face {
  std::array<Index, 3> corner;  // rows of the points
  Direction normal;
  double length;  // of the normal
  std::vector<Index> outside;
  Index farthest = 0;       // of `outside`
  std::int64_t height = 0;  // of that point: its distance times `length`
};

class Builder {
 public:
  explicit Builder(std::span<const GridPoint> points) : points_(points) {}

  ConvexHull build(std::size_t max_vertices) && {
    const std::optional<std::array<Index, 4>> first = simplex();
    if (!first) return {};
    const auto [a, b, c, d] = *first;
    for (const std::array<Index, 3>& corner : {std::array{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}}) add_face(corner);
    std::vector<Index> all(points_.size());
    for (Index i = 0; i < all.size(); ++i) all[i] = i;
    assign_outside_points(all, 0);
    for (std::size_t vertices = 4; vertices < max_vertices; ++vertices) {
      const Face* next = nullptr;
      for (const Face& face : faces_)
        if (face.height > 0 &&
            (next == nullptr || double(face.height) / face.length > double(next->height) / next->length))
          next = &face;
      if (next == nullptr) break;
      add_point(next->farthest);
    }
    return result();
  }

 private:
  /// Four points that span a volume, the fourth behind the first three.
  std::optional<std::array<Index, 4>> simplex() const {
    if (points_.size() < 4) return std::nullopt;
    const auto best = [this](const auto& measure) {
      Index found = 0;
      for (Index i = 1; i < points_.size(); ++i)
        if (measure(points_[i]) > measure(points_[found])) found = i;
      return found;
    };
    const Index a = best([](GridPoint p) { return std::tuple(-p.x, -p.y, -p.z); });
    const GridPoint from = points_[a];
    const Index b = best([from](GridPoint p) { return dot(p - from, p - from); });
    const Direction along = points_[b] - from;
    const auto off_line = [from, along](GridPoint p) {
      const Vec3<double> across = to_double(cross(along, p - from));
      return dot(across, across);
    };
    const Index c = best(off_line);
    if (!(off_line(points_[c]) > 0)) return std::nullopt;
    const auto height = [this, a, b, c](GridPoint p) { return orient(points_[a], points_[b], points_[c], p); };
    const Index d = best([height](GridPoint p) { return std::abs(height(p)); });
    if (height(points_[d]) == 0) return std::nullopt;
    return height(points_[d]) < 0 ? std::array{a, b, c, d} : std::array{a, c, b, d};
  }

  void add_face(const std::array<Index, 3>& corner) {
    const GridPoint a = points_[corner[0]];
    const Direction normal = cross(points_[corner[1]] - a, points_[corner[2]] - a);
    faces_.push_back({corner, normal, length(to_double(normal)), {}});
  }

  std::int64_t height(const Face& face, GridPoint p) const { return dot(face.normal, p - points_[face.corner[0]]); }

  /// Assigns each point to the first face, from `first` on, that it lies in front of. The other points are inside.
  void assign_outside_points(const std::vector<Index>& points, std::size_t first) {
    for (const Index i : points)
      for (std::size_t f = first; f < faces_.size(); ++f) {
        Face& face = faces_[f];
        const std::int64_t above = height(face, points_[i]);
        if (above <= 0) continue;
        face.outside.push_back(i);
        if (above > face.height || (above == face.height && i < face.farthest)) {
          face.height = above;
          face.farthest = i;
        }
        break;
      }
  }

  /// Replaces the faces visible from point `p` by a fan of faces from their border to `p`. The points assigned to the
  /// replaced faces are tested against the fan alone: each lies in front of a face of the fan, or inside the new hull.
  void add_point(Index p) {
    std::vector<Index> orphans;
    std::vector<std::array<Index, 2>> edges;
    std::vector<Face> kept;
    for (Face& face : faces_) {
      if (height(face, points_[p]) <= 0) {
        kept.push_back(std::move(face));
        continue;
      }
      orphans.insert(orphans.end(), face.outside.begin(), face.outside.end());
      for (std::size_t k = 0; k < 3; ++k) edges.push_back({face.corner[k], face.corner[(k + 1) % 3]});
    }
    faces_ = std::move(kept);
    const std::size_t first = faces_.size();
    std::vector<std::array<Index, 2>> sorted = edges;
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [a, b] : edges)
      if (!std::binary_search(sorted.begin(), sorted.end(), std::array{b, a})) add_face({a, b, p});
    assign_outside_points(orphans, first);
  }

  ConvexHull result() const {
    ConvexHull hull;
    std::vector<Index> used;
    for (const Face& face : faces_) used.insert(used.end(), face.corner.begin(), face.corner.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const Index i : used) hull.vertices.push_back(points_[i]);
    const auto row = [&used](Index i) { return Index(std::lower_bound(used.begin(), used.end(), i) - used.begin()); };
    const GridPoint from = hull.vertices[0];
    for (const Face& face : faces_) {
      hull.faces.push_back({row(face.corner[0]), row(face.corner[1]), row(face.corner[2])});
      hull.volume -= double(height(face, from));
    }
    hull.volume /= 6;
    return hull;
  }

  std::span<const GridPoint> points_;
  std::vector<Face> faces_;
};

}  // namespace

OrientedBox oriented_box(const ConvexHull& hull) {
  const ConvexHull coarse = convex_hull(hull.vertices, kFaceCorners);
  OrientedBox best = box_along(hull, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  double least = volume_of(box_along(coarse, best.axes));
  std::array<Vec3<double>, 3> axes = best.axes;
  for (const auto& [a, b, c] : coarse.faces) {
    const Vec3<double> from = to_double(coarse.vertices[a]);
    const Vec3<double> up = unit(cross(to_double(coarse.vertices[b]) - from, to_double(coarse.vertices[c]) - from));
    for (const auto& edge : coarse.faces)
      for (std::size_t k = 0; k < 3; ++k) {
        if (edge[k] > edge[(k + 1) % 3]) continue;  // each edge once
        const Vec3<double> along = to_double(coarse.vertices[edge[(k + 1) % 3]]) - to_double(coarse.vertices[edge[k]]);
        const Vec3<double> flat = along - dot(along, up) * up;
        if (dot(flat, flat) <= 1e-6 * dot(along, along)) continue;  // seen end on
        const Vec3<double> x = unit(flat);
        const OrientedBox box = box_along(coarse, {x, cross(up, x), up});
        if (volume_of(box) >= least) continue;
        least = volume_of(box);
        axes = box.axes;
      }
  }
  const OrientedBox turned = box_along(hull, axes);
  return volume_of(turned) < volume_of(best) ? turned : best;
}

ConvexHull convex_hull(std::span<const GridPoint> points, std::size_t max_vertices) {
  return Builder(points).build(max_vertices);
}

}  // namespace ngs::mesh
