#pragma once
// What of a model is there to be seen: its Gaussians as points with the area that they show, and where their bulk lies.
#include <cstdint>
#include <vector>

#include "ngs/scene/gaussian_cloud.h"
#include "ngs/stages/orbit/vectors.h"

namespace ngs::orbit {

/// Usable Gaussians that a renderer draws (opacity above 1/255).
struct SurfacePoints {
  std::vector<std::uint32_t> row;  // [M] of the model, increasing
  std::vector<Vec> position;       // [M] world, relative to the model's origin
  std::vector<double> opacity;     // [M] in (1/255, 1]
  std::vector<double> size;        // [M] largest standard deviation, world
  std::vector<double> area;        // [M] opacity times the ellipse of the two largest standard deviations, world²

  std::size_t count() const { return row.size(); }
};

SurfacePoints surface_points(const GaussianCloud& cloud);

struct Ball {
  Vec centre{0, 0, 0};  // world, relative to the model's origin
  double radius = 0;    // world, > 0
};

/// The bulk of a model. Its centre is the geometric median of the points by opacity, its radius reaches the far side of
/// 98 % of the opacity, but at most twice as far as half of it lies: a few Gaussians far away, and the surroundings of
/// a captured object, move neither. Turns and scales with the model. `points` are not empty.
Ball bulk_of(const SurfacePoints& points);

/// The smallest of the values below or at which `share` of the weight lies. Not empty.
double weighted_quantile(const std::vector<double>& values, const std::vector<double>& weights, double share);

/// Every k-th index of `count`, k the least that leaves no more than `most`.
std::vector<std::size_t> thinned(std::size_t count, std::size_t most);

}  // namespace ngs::orbit
