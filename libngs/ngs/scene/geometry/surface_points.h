#pragma once
// The visible Gaussians of a model as points with an area, and the ball that contains their bulk.
#include <cstdint>
#include <vector>

#include "ngs/math/vectors.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs::orbit {

/// Usable Gaussians that are rendered (opacity above 1/255).
struct SurfacePoints {
  std::vector<std::uint32_t> row;  // [M] rows of the model, ascending
  std::vector<Vec> position;       // [M] world, relative to the model's origin
  std::vector<double> opacity;     // [M] in (1/255, 1]
  std::vector<double> size;        // [M] largest standard deviation, world
  std::vector<double> area;        // [M] opacity times the ellipse of the two largest standard deviations, world²

  std::size_t count() const { return row.size(); }
  void add(const SurfacePoints& from, std::size_t i) {
    row.push_back(from.row[i]);
    position.push_back(from.position[i]);
    opacity.push_back(from.opacity[i]);
    size.push_back(from.size[i]);
    area.push_back(from.area[i]);
  }
};

SurfacePoints surface_points(const GaussianCloud& cloud);

struct Ball {
  Vec centre{0, 0, 0};  // world, relative to the model's origin
  double radius = 0;    // world, > 0
};

/// The bulk of a model. The centre is the geometric median of the points, weighted by opacity. The radius contains 98 %
/// of the opacity, and is at most twice the radius that contains 50 %. Far floaters and the surroundings of a captured
/// object therefore hardly change it. The ball rotates and scales with the model. `points` must not be empty.
Ball bulk_of(const SurfacePoints& points);

/// The smallest value with at least the fraction `share` of the weight at or below it. `values` must not be empty.
double weighted_quantile(const std::vector<double>& values, const std::vector<double>& weights, double share);

/// Every k-th index below `count`, with the smallest k that gives at most `max_count` indices.
std::vector<std::size_t> thinned(std::size_t count, std::size_t max_count);

}  // namespace ngs::orbit
