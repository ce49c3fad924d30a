#include "ngs/stages/orbit/frame.h"

#include <algorithm>
#include <array>

namespace ngs::orbit {
namespace {

constexpr std::size_t kMostSamples = 20000;
constexpr int kBins = 60;               // of heights, over three radii of the bulk
constexpr double kLeastSupport = 0.25;  // a plane must hold this much more than twice what lies below it

/// Sampled points about the bulk in radii, with the area that each shows. No Gaussian stands for more than a disc of a
/// tenth of the radius.
struct Samples {
  std::vector<Vec> position;
  std::vector<double> weight;  // sum 1
};

Samples samples_of(const SurfacePoints& points, const Ball& bulk) {
  Samples samples;
  double total = 0;
  for (const std::size_t i : thinned(points.count(), kMostSamples)) {
    const Vec p = (1 / bulk.radius) * (points.position[i] - bulk.centre);
    if (length(p) > 1.5) continue;
    const double area = std::min(points.area[i] / (bulk.radius * bulk.radius), 0.01 * points.opacity[i]);
    samples.position.push_back(p), samples.weight.push_back(area);
    total += area;
  }
  for (double& w : samples.weight) w /= total;
  return samples;
}

/// How much more of the samples lies in one slab of two bins than twice what lies below it, for the best slab.
double support(const Samples& samples, Vec up) {
  std::array<double, kBins> mass{};
  for (std::size_t i = 0; i < samples.position.size(); ++i) {
    const double height = (dot(up, samples.position[i]) + 1.5) / 3;
    mass[std::size_t(std::clamp(int(height * kBins), 0, kBins - 1))] += samples.weight[i];
  }
  double best = 0, below = 0;
  for (std::size_t b = 0; b + 1 < kBins; below += mass[b++])
    best = std::max(best, std::min(mass[b] + mass[b + 1] - 2 * below, 2 * (1 - below - mass[b] - mass[b + 1])));
  return best;
}

/// The best of `up` and directions about it, ever closer ones.
Vec refined(const Samples& samples, Vec up) {
  double best = support(samples, up);
  for (const double angle : {0.1, 0.05, 0.025, 0.0125}) {
    const Vec a = perpendicular(up), b = cross(up, a), from = up;
    for (int k = 0; k < 12; ++k) {
      const double turn = 6.283185307179586 * k / 12;
      const Vec tried = unit(from + angle * (std::cos(turn) * a + std::sin(turn) * b));
      const double score = support(samples, tried);
      if (score > best) best = score, up = tried;
    }
  }
  return up;
}

}  // namespace

UpGuess guess_up(const SurfacePoints& points, const Ball& bulk) {
  const Samples samples = samples_of(points, bulk);
  std::vector<Vec> tried = {{0, -1, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}};
  const std::vector<Vec> sphere = even_directions(600);
  tried.insert(tried.end(), sphere.begin(), sphere.end());
  UpGuess guess;
  double best = 0;
  for (const Vec& direction : tried)
    if (const double score = support(samples, direction); score > best) best = score, guess.up = direction;
  if (best > 0) guess.up = refined(samples, guess.up);
  guess.found = support(samples, guess.up) >= kLeastSupport;
  return guess.found ? guess : UpGuess{};
}

Frame frame_about(const SurfacePoints& points, const Ball& ball, Vec up) {
  const Vec a = perpendicular(up), b = cross(up, a);
  std::vector<std::array<double, 3>> samples;  // along a and b, weight
  double xx = 0, xy = 0, yy = 0;
  for (const std::size_t i : thinned(points.count(), 2 * kMostSamples)) {
    const Vec p = points.position[i] - ball.centre;
    if (length(p) > ball.radius) continue;
    const double x = dot(a, p) / ball.radius, y = dot(b, p) / ball.radius, w = points.opacity[i];
    samples.push_back({x, y, w});
    xx += w * x * x, xy += w * x * y, yy += w * y * y;
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
