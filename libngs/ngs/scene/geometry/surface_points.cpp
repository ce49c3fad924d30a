#include "ngs/scene/geometry/surface_points.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "ngs/math/stable.h"

namespace ngs::orbit {
namespace {

constexpr double kMinOpacity = 1.0 / 255;       // Gaussians below are not rendered
constexpr std::size_t kMaxBulkSamples = 50000;  // for means and quantiles

/// Weiszfeld's iteration from the weighted mean. Distances are at least 1/1000 of their mean.
Vec geometric_median(const SurfacePoints& points, const std::vector<std::size_t>& samples) {
  Vec centre{0, 0, 0};
  double total = 0;
  for (const std::size_t i : samples) {
    centre = centre + points.opacity[i] * points.position[i];
    total += points.opacity[i];
  }
  centre = (1 / total) * centre;
  for (int iteration = 0; iteration < 60; ++iteration) {
    double mean = 0;
    for (const std::size_t i : samples) mean += points.opacity[i] * length(points.position[i] - centre);
    const double least = 1e-3 * mean / total;
    if (!(least > 0)) break;
    Vec shift{0, 0, 0};
    double sum = 0;
    for (const std::size_t i : samples) {
      const Vec offset = points.position[i] - centre;
      const double weight = points.opacity[i] / std::max(length(offset), least);
      shift = shift + weight * offset;
      sum += weight;
    }
    centre = centre + (1 / sum) * shift;
  }
  return centre;
}

}  // namespace

SurfacePoints surface_points(const GaussianCloud& cloud) {
  SurfacePoints points;
  for (std::size_t i = 0; i < std::size_t(cloud.size()); ++i) {
    const double opacity = sigmoid(double(cloud.logit_opacity[i]));
    if (!cloud.usable[i] || !(opacity > kMinOpacity)) continue;
    const float* log_scale = &cloud.log_scale[3 * i];
    const auto [low, high] = std::minmax({log_scale[0], log_scale[1], log_scale[2]});
    const float middle =
        std::max(std::min(log_scale[0], log_scale[1]), std::min(std::max(log_scale[0], log_scale[1]), log_scale[2]));
    points.row.push_back(std::uint32_t(i));
    points.position.push_back({cloud.position[3 * i], cloud.position[3 * i + 1], cloud.position[3 * i + 2]});
    points.opacity.push_back(opacity);
    points.size.push_back(std::exp(double(high)));
    points.area.push_back(opacity * 3.14159265358979 * std::exp(double(high) + double(middle)));
  }
  return points;
}

std::vector<std::size_t> thinned(std::size_t count, std::size_t max_count) {
  const std::size_t step = std::max<std::size_t>(1, (count + max_count - 1) / max_count);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; i += step) indices.push_back(i);
  return indices;
}

double weighted_quantile(const std::vector<double>& values, const std::vector<double>& weights, double share) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] != values[b] ? values[a] < values[b] : a < b; });
  const double wanted = share * std::accumulate(weights.begin(), weights.end(), 0.0);
  double sum = 0;
  for (const std::size_t i : order)
    if ((sum += weights[i]) >= wanted) return values[i];
  return values[order.back()];
}

Ball bulk_of(const SurfacePoints& points) {
  const std::vector<std::size_t> samples = thinned(points.count(), kMaxBulkSamples);
  Ball bulk;
  bulk.centre = geometric_median(points, samples);
  std::vector<double> distance, weight;
  for (const std::size_t i : samples) {
    distance.push_back(length(points.position[i] - bulk.centre) + 2 * points.size[i]);
    weight.push_back(points.opacity[i]);
  }
  bulk.radius = std::min(weighted_quantile(distance, weight, 0.98), 2 * weighted_quantile(distance, weight, 0.5));
  bulk.radius = std::max(bulk.radius, std::numeric_limits<double>::min());
  return bulk;
}

}  // namespace ngs::orbit
