#include "ngs/scene/geometry/stance.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "ngs/math/median.h"

namespace ngs::orbit {
namespace {

constexpr std::size_t kMaxSamples = 20000;
constexpr double kSlab = 0.03;       // thickness of the base, relative to the object's height
constexpr double kOutliers = 0.004;  // fraction of the points ignored at the bottom, and at the top
constexpr int kDirections = 8;       // in which widths are measured
constexpr double kMaxTall = 1.5;     // upper bound on height / width in the score
constexpr double kMaxWide = 1.2;     // upper bound on base width / whole width in the score
constexpr double kPrior = 1.15;      // factor that favours -y over the other axes
// Measured on seven statues with and without pedestal, a guitar, a robot and a biker: base width / whole width 0.56 to
// 1.17; base width / width of a slab three times as thick 0.83 to 1.03; both larger on a tripod.
constexpr double kLeastBase = 0.2, kMostBase = 2, kLeastSharp = 0.72, kMostSharp = 1.4;
// Radius of 99.9 % of the opacity / radius of half: these objects 1.5 to 4.5, captures with surroundings 7.4 to 80, one
// 4.3. Size of outer Gaussians / inner ones: these objects 0.4 to 5.8, captures 6.8 to 32.
constexpr double kAll = 0.999, kMostReach = 6, kMostGrowth = 6.3;

struct Point {
  double height;
  std::array<double, 2> at;
};

/// Mean width of the points up to a height, without the outer 2 % at each side.
double width_below(const std::vector<Point>& points, double height) {
  std::vector<double> along;
  double sum = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double turn = std::numbers::pi * k / kDirections, x = std::cos(turn), y = std::sin(turn);
    along.clear();
    for (const Point& p : points)
      if (p.height <= height) along.push_back(x * p.at[0] + y * p.at[1]);
    if (along.size() < 8) return 0;
    const auto cut = std::ptrdiff_t(along.size() / 50);
    const auto low = along.begin() + cut, high = along.end() - 1 - cut;
    std::nth_element(along.begin(), high, along.end());
    std::nth_element(along.begin(), low, high);
    sum += *high - *low;
  }
  return sum / kDirections;
}

struct Base {
  double value = 0;
  bool is_base = false;
};

Base base_of(const SurfacePoints& points, Vec up) {
  const Vec a = perpendicular(up), b = cross(up, a);
  std::vector<Point> all;
  for (const std::size_t i : thinned(points.count(), kMaxSamples)) {
    const Vec p = points.position[i];
    all.push_back({dot(up, p), {dot(a, p), dot(b, p)}});
  }
  if (all.empty()) return {};
  std::sort(all.begin(), all.end(), [](const Point& x, const Point& y) { return x.height < y.height; });
  const auto outliers = std::size_t(kOutliers * double(all.size()));
  const double low = all[outliers].height, height = all[all.size() - 1 - outliers].height - low;
  const double base = width_below(all, low + kSlab * height), above = width_below(all, low + 3 * kSlab * height),
               whole = width_below(all, all.back().height);
  if (!(base > 0) || !(above > 0) || !(whole > 0)) return {};
  const double wide = base / whole, sharp = base / above;
  return {std::min(kMaxWide, wide) * sharp * std::min(kMaxTall, height / whole),
          wide >= kLeastBase && wide <= kMostBase && sharp >= kLeastSharp && sharp <= kMostSharp};
}

struct Distances {
  std::vector<double> distance, size, weight;  // [samples] to a centre, largest deviation, opacity
  double radius(double share) const { return weighted_quantile(distance, weight, share); }
};

Distances distances(const SurfacePoints& points, Vec centre) {
  Distances found;
  for (const std::size_t i : thinned(points.count(), kMaxSamples)) {
    found.distance.push_back(length(points.position[i] - centre));
    found.size.push_back(points.size[i]);
    found.weight.push_back(points.opacity[i]);
  }
  return found;
}

}  // namespace

bool is_alone(const SurfacePoints& points, Vec centre) {
  const Distances all = distances(points, centre);
  if (all.distance.empty()) return false;
  const double half = all.radius(0.5), outer = all.radius(0.98);
  std::vector<double> near, far;
  for (std::size_t i = 0; i < all.size.size(); ++i) {
    if (all.distance[i] <= half) near.push_back(all.size[i]);
    if (all.distance[i] >= outer) far.push_back(all.size[i]);
  }
  return all.radius(kAll) <= kMostReach * half &&
         quantile(std::move(far), 0.5) <= kMostGrowth * quantile(std::move(near), 0.5);
}

double stance(const SurfacePoints& points, Vec up) {
  const Base base = base_of(points, up);
  return base.is_base ? base.value - base_of(points, -1.0 * up).value : 0;
}

Stance best_stance(const SurfacePoints& points, const Ball& bulk) {
  Stance best;
  if (!is_alone(points, bulk.centre)) return best;
  best.value = stance(points, best.up);
  double most = std::max(0.0, kPrior * best.value);
  for (const Vec& axis : {Vec{0, 0, 1}, Vec{0, 1, 0}, Vec{1, 0, 0}, Vec{-1, 0, 0}, Vec{0, 0, -1}})
    if (const double value = stance(points, axis); value > most) {
      most = value;
      best = {axis, value};
    }
  return best;
}

Ball ball_to_frame(const SurfacePoints& points, const Ball& bulk, Vec up) {
  if (!is_alone(points, bulk.centre) || stance(points, up) < kClear) return bulk;
  std::vector<double> height, weight;
  for (const std::size_t i : thinned(points.count(), kMaxSamples)) {
    height.push_back(dot(up, points.position[i] - bulk.centre));
    weight.push_back(points.opacity[i]);
  }
  const double middle = 0.5 * (weighted_quantile(height, weight, 1 - kAll) + weighted_quantile(height, weight, kAll));
  const Vec centre = bulk.centre + middle * up;
  const double radius = distances(points, centre).radius(kAll);
  return radius > 0 ? Ball{centre, radius} : bulk;
}

}  // namespace ngs::orbit
