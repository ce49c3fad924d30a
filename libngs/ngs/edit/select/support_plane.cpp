#include "ngs/edit/select/support_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "ngs/edit/select/canonical_points.h"
#include "ngs/math/median.h"
#include "ngs/math/quat.h"

namespace ngs {
namespace {

using orbit::Vec;

constexpr std::size_t kMaxPlaneSamples = 40000;
constexpr int kDirections = 2000;    // over the sphere, 2.6 degrees apart
constexpr double kMaxTilt = 0.9063;  // cosine of 25 degrees
constexpr int kBins = 120;           // histogram bins of heights, over three radii of the bulk
constexpr double kMinAbove = 0.01;   // least fraction of all area above the plane: excludes a ceiling
constexpr double kMinShare = 0.05;   // least fraction of the flat area in the plane
constexpr int kFits = 12;
constexpr double kTolerance = 2 * 3.0 / kBins;  // of the first fit, radii of the bulk
constexpr double kThinnest = 0.1;           // least thickness of a plane that is left out, of SupportPlane::thickness
constexpr double kDeviations = 3 * 1.4826;  // three standard deviations per median absolute deviation

/// A Gaussian in units of the bulk's radius, relative to its centre.
struct Sample {
  Vec position;
  Vec normal;       // of its disc
  double area = 0;  // at most that of a disc of a tenth of the radius
  double flat = 0;  // 1 for a disc, 0 for a ball
  bool can_support = true;
};

/// The axis of the smallest standard deviation.
Vec normal_of(const GaussianCloud& cloud, std::size_t row) {
  const Mat3<double> axes = axes_of_quaternion(&cloud.rotation[4 * row]);
  const float* s = &cloud.log_scale[3 * row];
  const int least = int(std::min_element(s, s + 3) - s);
  return {axes(0, least), axes(1, least), axes(2, least)};
}

std::vector<Sample> samples_of(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const orbit::Ball& bulk,
                               const std::vector<std::uint8_t>& object = {}) {
  std::vector<Sample> samples;
  for (const std::size_t i : orbit::thinned(points.count(), kMaxPlaneSamples)) {
    const Vec p = (1 / bulk.radius) * (points.position[i] - bulk.centre);
    if (length(p) > 1.5) continue;
    std::array<float, 3> s;
    std::copy_n(&cloud.log_scale[3 * std::size_t(points.row[i])], 3, s.begin());
    std::sort(s.begin(), s.end());
    samples.push_back({p, normal_of(cloud, points.row[i]),
                       std::min(points.area[i] / (bulk.radius * bulk.radius), 0.01 * points.opacity[i]),
                       1 - std::exp(double(s[0]) - double(s[1])), object.empty() || !object[points.row[i]]});
  }
  return samples;
}

/// The weight of a sample for a plane of this normal. A ball has a small weight for every normal, so that planes are
/// found in models of isotropic Gaussians too.
double weight_for(const Sample& sample, Vec normal) {
  if (!sample.can_support) return 0;
  const double facing = dot(normal, sample.normal);
  const double aligned = facing * facing;
  return sample.area * (sample.flat * aligned * aligned + (1 - sample.flat) * 0.2);
}

struct Slab {
  Vec normal{0, 0, 1};
  double height = 0, weight = 0, share = 0;
};

/// The two adjacent height bins with the largest weight and enough area above them.
Slab best_slab(const std::vector<Sample>& samples, Vec normal) {
  std::array<double, kBins + 1> mass{}, all{};
  double total = 0, area = 0;
  for (const Sample& sample : samples) {
    const double height = (dot(normal, sample.position) + 1.5) / 3;
    const auto bin = std::size_t(std::clamp(int(height * kBins), 0, kBins - 1));
    const double weight = weight_for(sample, normal);
    mass[bin] += weight;
    all[bin] += sample.area;
    total += weight;
    area += sample.area;
  }
  Slab best{.normal = normal};
  double above = area - all[0];
  for (std::size_t b = 0; b < kBins; ++b, above -= all[b]) {
    const double in = mass[b] + mass[b + 1];
    if (above - all[b + 1] < kMinAbove * area || in <= best.weight) continue;
    best.height = 3 * double(b + 1) / kBins - 1.5;
    best.weight = in;
    best.share = in / total;
  }
  return best;
}

Slab best_slab_around(const std::vector<Sample>& samples, Vec up) {
  Slab best = best_slab(samples, up);
  for (const Vec& direction : orbit::even_directions(kDirections)) {
    if (dot(direction, up) < kMaxTilt) continue;
    const Slab slab = best_slab(samples, direction);
    if (slab.weight > 1.05 * best.weight) best = slab;
  }
  return best;
}

/// Least-squares plane of the heights of the samples within `tolerance` of `slab`.
Slab fitted(const std::vector<Sample>& samples, const Slab& slab, double tolerance) {
  const auto weight_of = [&](const Sample& sample) {
    return std::abs(dot(slab.normal, sample.position) - slab.height) <= tolerance ? weight_for(sample, slab.normal) : 0;
  };
  Vec mean{0, 0, 0};
  double total = 0;
  for (const Sample& sample : samples) {
    const double w = weight_of(sample);
    mean = mean + w * sample.position;
    total += w;
  }
  if (!(total > 0)) return slab;
  mean = (1 / total) * mean;
  const Vec a = orbit::perpendicular(slab.normal), b = cross(slab.normal, a);
  double aa = 0, ab = 0, bb = 0, ah = 0, bh = 0;  // the plane h = p a + q b through them
  for (const Sample& sample : samples) {
    const double w = weight_of(sample);
    const Vec d = sample.position - mean;
    const double x = dot(a, d), y = dot(b, d), h = dot(slab.normal, d);
    aa += w * x * x;
    ab += w * x * y;
    bb += w * y * y;
    ah += w * x * h;
    bh += w * y * h;
  }
  Slab out = slab;
  const double det = aa * bb - ab * ab;
  if (det > 1e-9 * (aa + bb) * (aa + bb))
    out.normal = unit(slab.normal - ((bb * ah - ab * bh) / det) * a - ((aa * bh - ab * ah) / det) * b);
  out.height = dot(out.normal, mean);
  return out;
}

/// Three standard deviations of the samples within `tolerance`, at least a thousandth of the radius.
double spread_of(const std::vector<Sample>& samples, const Slab& slab, double tolerance) {
  std::vector<double> distance, weight;
  for (const Sample& sample : samples) {
    const double d = std::abs(dot(slab.normal, sample.position) - slab.height);
    if (d <= tolerance) {
      distance.push_back(d);
      weight.push_back(weight_for(sample, slab.normal));
    }
  }
  if (distance.empty()) return tolerance;
  return std::clamp(kDeviations * orbit::weighted_quantile(distance, weight, 0.5), 1e-3, tolerance);
}

/// `slab` after kFits fits with a shrinking tolerance, in world units.
SupportPlane refitted(const std::vector<Sample>& samples, const orbit::Ball& bulk, Slab slab) {
  double tolerance = kTolerance;
  for (int fit = 0; fit < kFits; ++fit) {
    slab = fitted(samples, slab, tolerance);
    tolerance = spread_of(samples, slab, tolerance);
  }
  return {.found = true,
          .normal = slab.normal,
          .offset = bulk.radius * slab.height + dot(slab.normal, bulk.centre),
          .thickness = bulk.radius * tolerance,
          .support = slab.share};
}

}  // namespace

SupportPlane find_support_plane(const GaussianCloud& cloud, const orbit::SurfacePoints& points, Vec up,
                                const std::vector<std::uint8_t>& object) {
  SupportPlane plane{.normal = up};
  if (points.count() == 0) return plane;
  const orbit::Ball bulk = orbit::bulk_of(points);
  const std::vector<Sample> samples = samples_of(cloud, points, bulk, object);
  const Slab slab = best_slab_around(samples, up);
  if (slab.share < kMinShare) return plane;
  plane = refitted(samples, bulk, slab);
  plane.found = dot(plane.normal, up) >= kMaxTilt;
  return plane;
}

bool supports_object(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const SupportPlane& plane) {
  constexpr double kCell = 0.1, kClose = 0.5;  // radii of the bulk
  constexpr double kMinOpen = 0.2, kMaxBelow = 0.1, kThin = 0.9 * kTolerance;
  if (!plane.found || points.count() == 0) return false;
  const orbit::Ball bulk = orbit::bulk_of(points);
  const double offset = (plane.offset - dot(plane.normal, bulk.centre)) / bulk.radius;
  const double thickness = plane.thickness / bulk.radius;
  const Vec a = orbit::perpendicular(plane.normal), b = cross(plane.normal, a);
  std::set<std::pair<int, int>> of_plane, covered;
  double below = 0, all = 0;
  for (const Sample& sample : samples_of(cloud, points, bulk)) {
    const double height = dot(plane.normal, sample.position) - offset;
    const std::pair<int, int> cell{int(std::floor(dot(a, sample.position) / kCell)),
                                   int(std::floor(dot(b, sample.position) / kCell))};
    all += sample.area;
    if (height < -thickness)
      below += sample.area;
    else if (height <= thickness)
      of_plane.insert(cell);
    else if (height <= kClose)
      covered.insert(cell);
  }
  const auto open = std::ranges::count_if(of_plane, [&](const auto& cell) { return !covered.contains(cell); });
  return double(open) >= kMinOpen * double(of_plane.size()) && (below <= kMaxBelow * all || thickness < kThin);
}

SupportPlane refined_by(const GaussianCloud& cloud, const orbit::SurfacePoints& points, const SupportPlane& plane) {
  if (!plane.found || points.count() == 0) return plane;
  const orbit::Ball bulk = orbit::bulk_of(points);
  const double height = (plane.offset - dot(plane.normal, bulk.centre)) / bulk.radius;
  SupportPlane refined = refitted(samples_of(cloud, points, bulk), bulk,
                                  {.normal = plane.normal, .height = height, .share = plane.support});
  return dot(refined.normal, plane.normal) >= kMaxTilt ? refined : plane;
}

void remove_support(const GaussianCloud& cloud, Vec up, std::vector<std::uint8_t>& object) {
  const SupportPlane plane = find_support_plane(cloud, canonical_points(cloud), up, object);
  if (!plane.found) return;
  const auto distance = [&](std::size_t i) {
    const float* p = &cloud.position[3 * i];
    return std::abs(dot(plane.normal, {double(p[0]), double(p[1]), double(p[2])}) - plane.offset);
  };
  std::vector<double> outside;
  for (std::size_t i = 0; i < object.size(); ++i)
    if (!object[i] && distance(i) <= plane.thickness) outside.push_back(distance(i));
  if (outside.empty()) return;
  const double half =
      std::clamp(kDeviations * upper_median(std::move(outside)), kThinnest * plane.thickness, plane.thickness);
  for (std::size_t i = 0; i < object.size(); ++i)
    if (distance(i) <= half) object[i] = 0;
}

}  // namespace ngs
