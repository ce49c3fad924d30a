#include "ngs/scene/geometry/frame.h"

#include <algorithm>
#include <array>

#include "ngs/scene/geometry/stance.h"

namespace ngs::orbit {
namespace {

constexpr std::size_t kMaxFlatSamples = 20000;
constexpr int kBins = 60;             // histogram bins of heights, over three radii of the bulk
constexpr double kMinSupport = 0.25;  // least Slab::support of a plane
// A plane is a side of a lone object, not its floor, if the stance on it is much worse than the best. Best stance of
// five statues and guitars: 0.6 to 1.6, at most 0.38 of it on a side; of a robot on its floor: 0.35.
constexpr double kClearStance = 0.3, kSideStance = 0.5;

/// Sampled points relative to the bulk, in radii, weighted by area. The area of a Gaussian is limited to that of a disc
/// of a tenth of the radius.
struct Samples {
  std::vector<Vec> position;
  std::vector<double> weight;  // sum 1
};

Samples samples_of(const SurfacePoints& points, const Ball& bulk) {
  Samples samples;
  double total = 0;
  for (const std::size_t i : thinned(points.count(), kMaxFlatSamples)) {
    const Vec p = (1 / bulk.radius) * (points.position[i] - bulk.centre);
    if (length(p) > 1.5) continue;
    const double area = std::min(points.area[i] / (bulk.radius * bulk.radius), 0.01 * points.opacity[i]);
    samples.position.push_back(p);
    samples.weight.push_back(area);
    total += area;
  }
  for (double& w : samples.weight) w /= total;
  return samples;
}

/// A slab of two bins of heights.
struct Slab {
  double height = 0;   // its middle, in radii
  double support = 0;  // weight in the slab minus twice the weight below, at most five times the weight above
};

Slab best_slab(const Samples& samples, Vec up) {
  std::array<double, kBins> mass{};
  for (std::size_t i = 0; i < samples.position.size(); ++i) {
    const double height = (dot(up, samples.position[i]) + 1.5) / 3;
    mass[std::size_t(std::clamp(int(height * kBins), 0, kBins - 1))] += samples.weight[i];
  }
  Slab best;
  double below = 0;
  for (std::size_t b = 0; b + 1 < kBins; below += mass[b++]) {
    const double in = mass[b] + mass[b + 1], support = std::min(in - 2 * below, 5 * (1 - below - in));
    if (support > best.support) best = {3 * double(b + 1) / kBins - 1.5, support};
  }
  return best;
}

/// The normal of the least-squares plane of heights through the samples of the best slab, towards `up`.
Vec normal_of_slab(const Samples& samples, Vec up) {
  const Slab slab = best_slab(samples, up);
  Vec mean{0, 0, 0};
  double total = 0;
  const auto in_slab = [&](std::size_t i) {
    return std::abs(dot(up, samples.position[i]) - slab.height) < 1.5 / kBins * 3;
  };
  for (std::size_t i = 0; i < samples.position.size(); ++i)
    if (in_slab(i)) {
      mean = mean + samples.weight[i] * samples.position[i];
      total += samples.weight[i];
    }
  if (!(total > 0)) return up;
  mean = (1 / total) * mean;
  const Vec a = perpendicular(up), b = cross(up, a);
  double aa = 0, ab = 0, bb = 0, ah = 0, bh = 0;  // the plane h = p a + q b through them
  for (std::size_t i = 0; i < samples.position.size(); ++i) {
    if (!in_slab(i)) continue;
    const Vec d = samples.position[i] - mean;
    const double w = samples.weight[i], x = dot(a, d), y = dot(b, d), h = dot(up, d);
    aa += w * x * x;
    ab += w * x * y;
    bb += w * y * y;
    ah += w * x * h;
    bh += w * y * h;
  }
  const double det = aa * bb - ab * ab;
  if (!(det > 1e-9 * (aa + bb) * (aa + bb))) return up;
  return unit(up - ((bb * ah - ab * bh) / det) * a - ((aa * bh - ab * ah) / det) * b);
}

}  // namespace

UpGuess guess_up(const SurfacePoints& points, const Ball& bulk) {
  const Samples samples = samples_of(points, bulk);
  UpGuess guess;
  double best = 0;
  for (const Vec& direction : even_directions(600))
    if (const double support = best_slab(samples, direction).support; support > best) {
      best = support;
      guess.up = direction;
    }
  for (int k = 0; k < 4; ++k) guess.up = normal_of_slab(samples, guess.up);
  guess.found = best_slab(samples, guess.up).support >= kMinSupport;
  const Stance alone = best_stance(points, bulk);
  const bool is_side = alone.value >= kClearStance && stance(points, guess.up) < kSideStance * alone.value;
  if (guess.found && !is_side) return guess;
  return alone.is_clear() ? UpGuess{alone.up, true} : UpGuess{};
}

Frame frame_about(const SurfacePoints& points, const Ball& ball, Vec up) {
  const Vec a = perpendicular(up), b = cross(up, a);
  std::vector<std::array<double, 3>> samples;  // along a and b, weight
  double xx = 0, xy = 0, yy = 0;
  for (const std::size_t i : thinned(points.count(), 2 * kMaxFlatSamples)) {
    const Vec p = points.position[i] - ball.centre;
    if (length(p) > ball.radius) continue;
    const double x = dot(a, p) / ball.radius, y = dot(b, p) / ball.radius, w = points.opacity[i];
    samples.push_back({x, y, w});
    xx += w * x * x;
    xy += w * x * y;
    yy += w * y * y;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  Vec x_axis = std::cos(angle) * a + std::sin(angle) * b;
  double skew = 0;
  for (const auto& [x, y, w] : samples) {
    const double along = std::cos(angle) * x + std::sin(angle) * y;
    skew += w * along * along * along;
  }
  if (skew < 0) x_axis = -1.0 * x_axis;
  const Vec y_axis = cross(up, x_axis);
  return {ball.centre, {{x_axis.x, x_axis.y, x_axis.z, y_axis.x, y_axis.y, y_axis.z, up.x, up.y, up.z}}};
}

}  // namespace ngs::orbit
