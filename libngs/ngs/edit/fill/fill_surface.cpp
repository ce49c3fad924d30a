#include "ngs/edit/fill/fill_surface.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ngs/backend/for_each.h"
#include "ngs/core/rng.h"
#include "ngs/math/median.h"
#include "ngs/math/quat.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr std::size_t kMinPoints = 12, kMaxPlanes = 4, kMaxScored = 3000;
constexpr int kHypotheses = 1500, kRefits = 6;
constexpr double kMinShare = 0.08;          // minimum share of the rim's solid Gaussians that lie in a plane
constexpr double kFacing = 0.6;             // least cosine between a flat Gaussian's normal and the plane's
constexpr double kFlat = 0.5;               // largest ratio of the two smallest sizes of a flat Gaussian
constexpr double kOneSided = 0.9;           // least fraction of the object in front of a surface
constexpr double kInFront = 0.98;           // the same for a plane of supporting_planes()
constexpr double kDeviations = 3 * 1.4826;  // three standard deviations per median absolute deviation
constexpr double kRelief = 0.12;            // diagonals: heights of curved ground over its plane, to either side
constexpr std::size_t kMaxCentres = 180;
constexpr double kSmoothing = 1e-3;  // of the relief: heights of single Gaussians have noise

struct RimPoint {
  Vec position;
  Vec normal;         // of its disc
  bool flat = false;  // the normal is defined
};

std::vector<RimPoint> rim_points(const GaussianCloud& cloud, const Rim& rim) {
  std::vector<RimPoint> points;
  for (const std::uint32_t k : rim.solid) {
    const std::size_t row = rim.background.row[k];
    const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * row]);
    const float* s = &cloud.log_scale[3 * row];
    const int least = int(std::min_element(s, s + 3) - s);
    const std::array<double, 3> size = sorted_sizes(cloud, row);
    points.push_back(
        {rim.background.position[k], {axes(0, least), axes(1, least), axes(2, least)}, size[0] <= kFlat * size[1]});
  }
  return points;
}

struct FlatPlane {
  Vec normal{0, 0, 1};
  double offset = 0;

  double height(Vec p) const { return dot(normal, p) - offset; }
  bool contains(const RimPoint& p, double tolerance) const {
    return std::abs(height(p.position)) <= tolerance && (!p.flat || std::abs(dot(normal, p.normal)) >= kFacing);
  }
};

std::optional<FlatPlane> through(const std::vector<RimPoint>& points, double spacing, std::uint64_t seed,
                                 std::uint64_t draw) {
  std::array<Vec, 3> p;
  for (std::uint64_t k = 0; k < 3; ++k) {
    const double at = rng_uniform(seed, RngStream::kFill, 3 * draw + k) * double(points.size());
    p[k] = points[std::min(points.size() - 1, std::size_t(at))].position;
  }
  const Vec across = cross(p[1] - p[0], p[2] - p[0]);
  const double twice_area = length(across);
  if (!(twice_area > spacing * spacing)) return std::nullopt;  // too near each other for a direction
  const Vec normal = (1 / twice_area) * across;
  return FlatPlane{normal, dot(normal, p[0])};
}

/// Least-squares plane of the points that `plane` contains; nullopt if these are on one line.
std::optional<FlatPlane> least_squares(const std::vector<RimPoint>& points, const FlatPlane& plane, double tolerance) {
  Vec mean{0, 0, 0};
  double count = 0;
  for (const RimPoint& p : points)
    if (plane.contains(p, tolerance)) {
      mean = mean + p.position;
      ++count;
    }
  if (count < 3) return std::nullopt;
  mean = (1 / count) * mean;
  const Vec a = orbit::perpendicular(plane.normal), b = cross(plane.normal, a);
  double aa = 0, ab = 0, bb = 0, ah = 0, bh = 0;
  for (const RimPoint& p : points) {
    if (!plane.contains(p, tolerance)) continue;
    const Vec d = p.position - mean;
    const double x = dot(a, d), y = dot(b, d), h = dot(plane.normal, d);
    aa += x * x;
    ab += x * y;
    bb += y * y;
    ah += x * h;
    bh += y * h;
  }
  const double det = aa * bb - ab * ab;
  if (!(det > 1e-4 * (aa + bb) * (aa + bb))) return std::nullopt;
  const Vec normal = unit(plane.normal - ((bb * ah - ab * bh) / det) * a - ((aa * bh - ab * ah) / det) * b);
  return FlatPlane{normal, dot(normal, mean)};
}

/// The plane of three random points that contains most points, refitted. nullopt: all draws are degenerate.
std::optional<FlatPlane> best_plane(const Exec& exec, const std::vector<RimPoint>& points, double spacing,
                                    double tolerance, std::uint64_t seed) {
  std::vector<RimPoint> scored;
  for (const std::size_t i : orbit::thinned(points.size(), kMaxScored)) scored.push_back(points[i]);
  std::vector<std::int64_t> score(kHypotheses);
  for_each_index(exec, kHypotheses, [&](std::int64_t k) {
    const std::optional<FlatPlane> plane = through(points, spacing, seed, std::uint64_t(k));
    if (!plane) return;
    score[std::size_t(k)] =
        std::ranges::count_if(scored, [&](const RimPoint& p) { return plane->contains(p, tolerance); });
  });
  const auto best = std::ranges::max_element(score);
  if (*best == 0) return std::nullopt;
  std::optional<FlatPlane> plane = through(points, spacing, seed, std::uint64_t(best - score.begin()));
  for (int fit = 0; fit < kRefits && plane; ++fit) plane = least_squares(points, *plane, tolerance);
  return plane;
}

std::vector<RimPoint> contained(const std::vector<RimPoint>& points, const FlatPlane& plane, double tolerance) {
  std::vector<RimPoint> in;
  std::ranges::copy_if(points, std::back_inserter(in), [&](const RimPoint& p) { return plane.contains(p, tolerance); });
  return in;
}

/// Sets tolerance, spacing and residual from the points of the surface.
void measure(const Exec& exec, const std::vector<RimPoint>& points, FillSurface& surface) {
  std::vector<double> distance;
  std::vector<Vec> positions;
  for (const RimPoint& p : points) {
    distance.push_back(std::abs(surface.height(p.position)));
    positions.push_back(p.position);
  }
  surface.rim_points = std::int64_t(points.size());
  surface.residual = upper_median(std::move(distance));
  surface.spacing = surface_spacing(exec, positions);
  surface.tolerance = std::max(kDeviations * surface.residual, 0.5 * surface.spacing);
}

/// Whether the object is in front of the surface. Turns the normal of a plane towards the object.
bool stands_on(const Rim& rim, FillSurface& surface) {
  const auto in_front = [&](double sign) {
    double count = 0;
    for (const Vec& p : rim.object.position) count += sign * surface.height(p) > -2 * surface.tolerance;
    return count / double(rim.object.count());
  };
  std::vector<double> heights;
  for (const Vec& p : rim.object.position) heights.push_back(surface.height(p));
  if (upper_median(std::move(heights)) < 0 && surface.relief.empty()) surface.set_axes(-1.0 * surface.normal);
  return in_front(1) >= kOneSided;
}

std::vector<FillSurface> find_planes(const Exec& exec, const Rim& rim, std::vector<RimPoint> points,
                                     std::uint64_t seed) {
  std::vector<FillSurface> surfaces;
  const std::size_t all = points.size();
  const double tolerance = 0.5 * rim.spacing;
  for (std::uint64_t round = 0; round < 2 * kMaxPlanes && surfaces.size() < kMaxPlanes; ++round) {
    if (points.size() < kMinPoints) break;
    const std::optional<FlatPlane> plane = best_plane(exec, points, rim.spacing, tolerance, seed + round);
    if (!plane) break;
    const std::vector<RimPoint> in = contained(points, *plane, tolerance);
    if (in.size() < std::max(kMinPoints, std::size_t(kMinShare * double(all)))) break;
    FillSurface surface;
    surface.origin = plane->offset * plane->normal;
    surface.set_axes(plane->normal);
    measure(exec, in, surface);
    if (surface.spacing > 0 && stands_on(rim, surface)) surfaces.push_back(surface);
    std::erase_if(points, [&](const RimPoint& p) { return plane->contains(p, 2 * tolerance); });
  }
  return surfaces;
}

struct Heights {
  std::vector<Vec2<double>> at;
  std::vector<double> height;
};

/// Averages positions and heights over square cells, so that few enough points are left to fit a spline.
Heights cell_means(const FillSurface& plane, const std::vector<RimPoint>& points) {
  Vec2<double> low{1e300, 1e300}, high{-1e300, -1e300};
  for (const RimPoint& p : points) {
    const Vec2<double> at = plane.coordinates(p.position);
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  const double side = std::sqrt(std::max((high.x - low.x) * (high.y - low.y), 1e-300) / double(kMaxCentres)) * 1.0001;
  struct Sum {
    double u = 0, v = 0, h = 0, count = 0;
  };
  const auto columns = std::size_t((high.x - low.x) / side) + 1, rows = std::size_t((high.y - low.y) / side) + 1;
  std::vector<Sum> cells(columns * rows);
  for (const RimPoint& p : points) {
    const Vec2<double> at = plane.coordinates(p.position);
    Sum& cell = cells[std::size_t((at.y - low.y) / side) * columns + std::size_t((at.x - low.x) / side)];
    cell.u += at.x;
    cell.v += at.y;
    cell.h += dot(plane.normal, p.position - plane.origin);
    ++cell.count;
  }
  Heights means;
  for (const Sum& cell : cells)
    if (cell.count > 0) {
      means.at.push_back({cell.u / cell.count, cell.v / cell.count});
      means.height.push_back(cell.h / cell.count);
    }
  return means;
}

std::vector<RimPoint> within(const std::vector<RimPoint>& points, const FillSurface& surface, double tolerance) {
  std::vector<RimPoint> in;
  std::ranges::copy_if(points, std::back_inserter(in),
                       [&](const RimPoint& p) { return std::abs(surface.height(p.position)) <= tolerance; });
  return in;
}

/// Curved ground: a thin plate over the plane that has most points within a wide tolerance. Points far from the plate
/// are dropped, and the rest fitted again.
std::optional<FillSurface> find_ground(const Exec& exec, const Rim& rim, const std::vector<RimPoint>& points,
                                       std::uint64_t seed) {
  constexpr int kFits = 4;
  if (points.size() < kMinPoints) return std::nullopt;
  double tolerance = std::max(kRelief * rim.diagonal, rim.spacing);
  const std::optional<FlatPlane> plane = best_plane(exec, points, rim.spacing, tolerance, seed + 2 * kMaxPlanes);
  if (!plane) return std::nullopt;
  FillSurface surface;
  surface.origin = plane->offset * plane->normal;
  surface.set_axes(plane->normal);
  surface.tolerance = tolerance;
  if (!stands_on(rim, surface)) return std::nullopt;
  std::vector<RimPoint> sample;
  for (const std::size_t i : orbit::thinned(points.size(), kMaxScored)) sample.push_back(points[i]);
  for (int fit = 0; fit < kFits; ++fit) {
    const std::vector<RimPoint> in = within(sample, surface, tolerance);
    if (in.size() < kMinPoints) return std::nullopt;
    const Heights means = cell_means(surface, in);
    surface.relief = ThinPlate(means.at, means.height, kSmoothing);
    if (surface.relief.empty()) return std::nullopt;
    std::vector<double> distance;
    for (const RimPoint& p : in) distance.push_back(std::abs(surface.height(p.position)));
    tolerance = std::min(tolerance, std::max(kDeviations * upper_median(std::move(distance)), 0.5 * rim.spacing));
  }
  const std::vector<RimPoint> in = within(points, surface, tolerance);
  measure(exec, in, surface);
  if (!(surface.spacing > 0) || !stands_on(rim, surface)) return std::nullopt;
  return surface;
}

/// Whether curved ground contains clearly more rim points than the planes, or about as many with a clearly smaller
/// residual. In the second case the planes' residual must be large relative to their spacing.
bool is_better(const FillSurface& ground, const std::vector<FillSurface>& planes) {
  constexpr double kClearlyMore = 1.25, kAsMuch = 0.95, kClearlyLess = 0.6, kMatters = 0.15, kFits = 0.3;
  double points = 0, residual = 0, spacing = 0;
  for (const FillSurface& plane : planes) {
    points += double(plane.rim_points);
    residual = std::max(residual, plane.residual);
    spacing = std::max(spacing, plane.spacing);
  }
  const auto of_ground = double(ground.rim_points);
  if (ground.residual > kFits * ground.spacing && !planes.empty()) return false;  // the ground is a mean over clutter
  return of_ground >= kClearlyMore * points ||
         (of_ground >= kAsMuch * points && residual > kMatters * spacing && ground.residual < kClearlyLess * residual);
}

}  // namespace

std::vector<FillSurface> find_fill_surfaces(const Exec& exec, const GaussianCloud& cloud, const Rim& rim, FillKind kind,
                                            std::uint64_t seed) {
  if (rim.solid.size() < kMinPoints || !(rim.spacing > 0)) return {};
  const std::vector<RimPoint> points = rim_points(cloud, rim);
  std::vector<FillSurface> planes;
  if (kind != FillKind::kSurface) planes = find_planes(exec, rim, points, seed);
  if (kind == FillKind::kPlane) return planes;
  const std::optional<FillSurface> ground = find_ground(exec, rim, points, seed);
  if (!ground || (kind == FillKind::kAuto && !is_better(*ground, planes))) return planes;
  return {*ground};
}

std::vector<FillSurface> supporting_planes(const Exec& exec, const GaussianCloud& cloud,
                                           const std::vector<std::uint8_t>& object, std::uint64_t seed) {
  const Rim rim = find_rim(exec, cloud, object);
  std::vector<FillSurface> planes = find_fill_surfaces(exec, cloud, rim, FillKind::kPlane, seed);
  std::erase_if(planes, [&](const FillSurface& plane) {
    const auto in_front =
        std::ranges::count_if(rim.object.position, [&](Vec p) { return plane.height(p) > -2 * plane.tolerance; });
    return double(in_front) < kInFront * double(rim.object.count());
  });
  return planes;
}

}  // namespace ngs
