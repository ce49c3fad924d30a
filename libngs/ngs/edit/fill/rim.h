#pragma once
// Collects the Gaussians of a removed object and the background Gaussians around it.
#include <cstdint>
#include <vector>

#include "ngs/backend/exec.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs {

/// An axis-aligned box.
struct Box {
  orbit::Vec low{0, 0, 0}, high{0, 0, 0};

  bool contains(orbit::Vec p, double margin) const {
    return p.x >= low.x - margin && p.x <= high.x + margin && p.y >= low.y - margin && p.y <= high.y + margin &&
           p.z >= low.z - margin && p.z <= high.z + margin;
  }
  double diagonal() const { return length(high - low); }
};

/// Rows are ascending. Without a rendered Gaussian of the object, all lists are empty.
struct Rim {
  orbit::SurfacePoints object;       // rendered Gaussians of the object, without outliers far from its bulk
  orbit::SurfacePoints background;   // rendered Gaussians of the background within 0.6 diagonals of `box`
  std::vector<std::uint32_t> solid;  // indices into `background`: opacity above 1/2, no needle, within 1/4 diagonal
  Box box;                           // bounding box of `object`, world, relative to the model's origin
  double diagonal = 0;               // of the box, world
  double spacing = 0;                // usual distance of neighbours in `solid`, world; 0: fewer than two
};

/// `object` [N] 1: the Gaussian was removed. Unusable Gaussians are in no list.
Rim find_rim(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::uint8_t>& object);

/// Spacing of a square grid with the density of these surface points, estimated from the distance to the fourth
/// neighbour. 0 for fewer than two points, or if most coincide.
double surface_spacing(const Exec& exec, const std::vector<orbit::Vec>& points);

/// Standard deviations of a row, ascending, world.
std::array<double, 3> sorted_sizes(const GaussianCloud& cloud, std::size_t row);

}  // namespace ngs
