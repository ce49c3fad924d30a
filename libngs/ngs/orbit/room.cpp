#include <algorithm>
#include <numbers>

#include "ngs/backend/for_each.h"
#include "ngs/orbit/rigs.h"

namespace ngs::orbit {
namespace {

constexpr double kOpaque = 1;        // optical depth that ends a ray
constexpr double kSurrounded = 0.6;  // fraction of all directions in which mass must lie
constexpr double kClearance = 0.18;  // free distance around a viewpoint, in radii
constexpr double kFarthest = 2.5;    // length of rays, in radii
constexpr std::size_t kMaxViewpoints = 16;

struct Viewpoint {
  Vec at;
  double clearance;  // world: 5 % quantile of the free lengths over all directions
};

/// Whether a point is free and surrounded by mass; sets its clearance.
bool viewpoint_at(const FreeSpace& space, double radius, Vec at, Viewpoint& viewpoint) {
  static const std::vector<Vec> directions = even_directions(160);
  if (space.depth_at(at) > 0.05) return false;
  const double max_length = kFarthest * radius;
  std::vector<double> reach;
  for (const Vec& d : directions) reach.push_back(space.free_length(at, d, {kOpaque, max_length}));
  std::sort(reach.begin(), reach.end());
  const auto surrounded = std::size_t(kSurrounded * double(reach.size()));
  viewpoint = {at, reach[reach.size() / 20]};
  return reach[surrounded] < max_length && viewpoint.clearance >= kClearance * radius;
}

/// Farthest-point sampling, from the viewpoint with the largest clearance.
std::vector<Vec> farthest_points(const std::vector<Viewpoint>& viewpoints, double radius) {
  std::vector<Vec> chosen;
  std::vector<double> distance(viewpoints.size(), 0);
  for (std::size_t i = 0; i < viewpoints.size(); ++i) distance[i] = kFarthest * radius + viewpoints[i].clearance;
  while (chosen.size() < kMaxViewpoints && !viewpoints.empty()) {
    const auto next = std::size_t(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (distance[next] < kClearance * radius) break;
    chosen.push_back(viewpoints[next].at);
    for (std::size_t i = 0; i < viewpoints.size(); ++i)
      distance[i] = std::min(distance[i], length(viewpoints[i].at - chosen.back()));
  }
  return chosen;
}

struct Ray {
  Vec from, direction;
};

using Cells = std::vector<std::uint8_t>;  // [cells] 1: ends a ray

/// The cells that stop at least one of the rays rays_of(0) ... rays_of(count - 1).
template <class RaysOf>
Cells stopping_cells(const Exec& exec, const FreeSpace& space, std::size_t count, const RaysOf& rays_of) {
  const double max_length = 4 * space.half();
  std::vector<Cells> stops(count);
  for_each_task(exec, std::int64_t(count), [&](std::int64_t i) {
    Cells& mine = stops[std::size_t(i)];
    mine.assign(space.cells(), 0);
    for (const Ray& ray : rays_of(std::size_t(i))) {
      const double reach = space.free_length(ray.from, ray.direction, {kOpaque, max_length});
      const Vec end = ray.from + (reach + 0.25 * space.cell_size()) * ray.direction;
      if (const std::int64_t cell = reach < max_length ? space.cell_at(end) : -1; cell >= 0)
        mine[std::size_t(cell)] = 1;
    }
  });
  Cells any(space.cells(), 0);
  for (const Cells& mine : stops)
    for (std::size_t cell = 0; cell < any.size(); ++cell) any[cell] |= mine[cell];
  return any;
}

/// Dilation by two cells along each axis: a wall seen from its other side is the same wall.
Cells widened(Cells cells, int side) {
  const auto n = std::int64_t(side);
  for (const std::int64_t stride : {std::int64_t(1), n, n * n}) {
    const Cells before = cells;
    for (std::int64_t cell = 0; cell < std::ssize(cells); ++cell)
      for (std::int64_t step = -2; step <= 2; ++step) {
        const std::int64_t at = cell / stride % n + step;
        if (at >= 0 && at < n) cells[std::size_t(cell)] |= before[std::size_t(cell + step * stride)];
      }
  }
  return cells;
}

double count_beyond(const Cells& cells, const Cells& others) {
  double count = 0;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) count += cells[cell] && !others[cell];
  return count;
}

/// Directions from which an object is usually viewed: all around, slightly above or below.
std::vector<Vec> sides_of_an_object() {
  std::vector<Vec> sides;
  for (const double elevation : {-0.3, 0.0, 0.3})
    for (int k = 0; k < 6; ++k) {
      const double azimuth = std::numbers::pi / 3 * (k + elevation);
      sides.push_back(
          {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)});
    }
  return sides;
}

/// Parallel rays from far outside, dense enough to hit every cell of a level plane at grazing angles.
std::vector<Ray> rays_from(const FreeSpace& space, Vec out) {
  const double half = space.half() * std::numbers::sqrt3, across = space.cell_size(), upwards = 0.3 * across;
  const Vec a = unit(cross({0, 0, 1}, out)), b = cross(out, a);
  std::vector<Ray> rays;
  for (double x = -half; x < half; x += across)
    for (double y = -half; y < half; y += upwards) rays.push_back({half * out + x * a + y * b, -1.0 * out});
  return rays;
}

}  // namespace

RoomFinding find_room(const Exec& exec, const FreeSpace& space, double radius) {
  constexpr int kSide = 13;  // points per axis of the lattice of tried points
  std::vector<Viewpoint> tried(kSide * kSide * kSide);
  std::vector<std::uint8_t> is_viewpoint(tried.size(), 0);
  for_each_task(exec, kSide * kSide * kSide, [&](std::int64_t i) {
    const auto coordinate = [&](std::int64_t k) { return 0.9 * radius * (2.0 * double(k % kSide) / (kSide - 1) - 1); };
    const Vec at{coordinate(i), coordinate(i / kSide), coordinate(i / kSide / kSide)};
    is_viewpoint[std::size_t(i)] = viewpoint_at(space, radius, at, tried[std::size_t(i)]);
  });
  std::vector<Viewpoint> viewpoints;
  for (std::size_t i = 0; i < tried.size(); ++i)
    if (is_viewpoint[i]) viewpoints.push_back(tried[i]);
  RoomFinding room;
  if (viewpoints.empty()) return room;
  room.viewpoints = farthest_points(viewpoints, radius);
  const std::vector<Vec> all_round = even_directions(12000), sides = sides_of_an_object();
  const Cells inside = stopping_cells(exec, space, room.viewpoints.size(), [&](std::size_t i) {
    std::vector<Ray> rays;
    for (const Vec& d : all_round) rays.push_back({room.viewpoints[i], d});
    return rays;
  });
  const Cells outside =
      stopping_cells(exec, space, sides.size(), [&](std::size_t i) { return rays_from(space, sides[i]); });
  room.seen_inside = double(std::ranges::count(inside, 1));
  room.only_inside = count_beyond(inside, widened(outside, space.side()));
  room.only_outside = count_beyond(outside, widened(inside, space.side()));
  return room;
}

Rig cameras_within(const std::vector<Vec>& viewpoints, double radius) {
  Rig rig;
  const auto look = [&](Vec at, double azimuth, double elevation) {
    const Vec d{std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
    rig.poses.push_back({at, at + radius * d});
  };
  for (std::size_t s = 0; s < viewpoints.size(); ++s) {
    const double phase = 2.4 * double(s);  // the golden angle: directions differ between viewpoints
    for (int k = 0; k < 8; ++k) look(viewpoints[s], phase + k * std::numbers::pi / 4, -0.1);
    for (int k = 0; k < 4; ++k) look(viewpoints[s], phase + k * std::numbers::pi / 2, -0.8);
    for (int k = 0; k < 3; ++k) look(viewpoints[s], phase + k * std::numbers::pi / 1.5, 0.7);
  }
  return rig;
}

}  // namespace ngs::orbit
