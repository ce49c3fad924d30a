#include "ngs/mesh/collider/solid_rays.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace ngs::mesh {
namespace {

/// A ray that passes a face; `change` is +1 where it enters.
struct Crossing {
  std::int32_t i, j;
  double z;
  int change;
  std::uint32_t face;
};

std::int64_t place_of(std::int64_t ray, std::int64_t pitch) { return ray * pitch + pitch / 2; }
/// The first ray at x or behind it.
std::int64_t first_ray(std::int64_t x, std::int64_t pitch) {
  const std::int64_t before = x - pitch / 2;
  return before > 0 ? (before + pitch - 1) / pitch : before / pitch;
}

/// A triangle seen along z, counter-clockwise. A point on an edge belongs to one of the two triangles at that edge.
class Shadow {
 public:
  Shadow(GridPoint a, GridPoint b, GridPoint c) : corner_{a, b, c} {}
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
  const Shadow shadow = n.z > 0 ? Shadow(a, b, c) : Shadow(a, c, b);
  const auto [low_x, high_x] = std::minmax({a.x, b.x, c.x});
  const auto [low_y, high_y] = std::minmax({a.y, b.y, c.y});
  for (std::int64_t j = first_ray(low_y, pitch); place_of(j, pitch) <= high_y; ++j)
    for (std::int64_t i = first_ray(low_x, pitch); place_of(i, pitch) <= high_x; ++i) {
      const std::int64_t x = place_of(i, pitch);
      const std::int64_t y = place_of(j, pitch);
      if (!shadow.has(x, y)) continue;
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

/// A span starts or ends, of the mesh or of a part.
struct Event {
  std::int32_t i, j;
  double z;
  bool of_part;
  int change;
};

}  // namespace

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

}  // namespace ngs::mesh
