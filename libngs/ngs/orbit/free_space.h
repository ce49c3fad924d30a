#pragma once
// Free space in a model: its extinction on a voxel grid, and the free length of rays.
//
// A Gaussian of opacity o and standard deviations a, b, c absorbs from parallel light, in the mean over its three axes,
// as much as an opaque patch of area o 2 pi (ab + bc + ca) / 3. This area per cell volume is the extinction per length.
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/geometry/frame.h"

namespace ngs::orbit {

class FreeSpace {
 public:
  /// A cube of half-width `half` around the frame's centre with `cells` cells per axis.
  struct Cube {
    double half = 1;  // world
    int cells = 96;
  };
  FreeSpace(const GaussianCloud& cloud, const SurfacePoints& points, const Frame& frame, Cube cube);

  /// The length of a ray up to an optical depth of `limit`, at most `most`. Frame coordinates, `direction` of unit
  /// length. Outside the cube the extinction is 0.
  struct Reach {
    double limit = 1, most = 1;
  };
  double free_length(Vec from, Vec direction, Reach reach) const;
  /// The index of a point's cell, -1 outside the cube.
  std::int64_t cell_at(Vec p) const;
  /// Optical depth over the width of the cell of a point; 0 outside.
  double depth_at(Vec p) const;

  double cell_size() const { return size_; }
  double half() const { return cube_.half; }
  int side() const { return cube_.cells; }  // cells along an axis
  std::size_t cells() const { return extinction_.size(); }

 private:
  Cube cube_;
  double size_;                    // of a cell, world
  std::vector<float> extinction_;  // [cells, cells, cells] z, y, x; per world unit
};

}  // namespace ngs::orbit
