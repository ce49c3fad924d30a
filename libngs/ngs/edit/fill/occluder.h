#pragma once
// Occupancy grid of the removed object, for ray casts: does the object hide a point from a direction?
#include <cstdint>
#include <vector>

#include "ngs/edit/fill/rim.h"
#include "ngs/scene/gaussian_cloud.h"

namespace ngs {

class Occluder {
 public:
  /// Marks the cells that a Gaussian of the object with opacity above 1/4 reaches with one standard deviation.
  explicit Occluder(const Rim& rim);

  /// Whether the straight line from `from` along the unit direction meets the object. Cells within one cell of `from`
  /// do not count: they touch the surface that the object stands on.
  bool hides(orbit::Vec from, orbit::Vec direction) const;
  /// Whether the object has a cell that contains the point.
  bool contains(orbit::Vec p) const;

 private:
  std::int64_t cell_of(orbit::Vec p) const;  // -1: outside

  orbit::Vec low_{0, 0, 0};
  double side_ = 1, reach_ = 0;  // world
  std::int64_t x_ = 0, y_ = 0, z_ = 0;
  std::vector<std::uint8_t> occupied_;
};

}  // namespace ngs
