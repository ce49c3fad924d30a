#pragma once
// Where a model lets light through: its extinction on a cube of cells, and how far rays get in it.
//
// A Gaussian of opacity o and standard deviations a, b, c takes from parallel light, in the mean over its three axes,
// as much as an opaque patch of o 2 pi (ab + bc + ca) / 3. That over the volume of a cell is extinction per length.
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/stages/orbit/frame.h"

namespace ngs::orbit {

class FreeSpace {
 public:
  /// Of the points within the cube of `half` about the frame's centre, `cells` a side.
  struct Cube {
    double half = 1;  // world
    int cells = 96;
  };
  FreeSpace(const GaussianCloud& cloud, const SurfacePoints& points, const Frame& frame, Cube cube);

  /// How far a ray gets before it meets an optical depth of `limit`, at most `most`; in the frame, `direction` of unit
  /// length. Beyond the cube all is free.
  struct Reach {
    double limit = 1, most = 1;
  };
  double free_length(Vec from, Vec direction, Reach reach) const;
  /// The cell of a point, -1 outside.
  std::int64_t cell_at(Vec p) const;
  /// Optical depth over the width of the cell of a point; 0 outside.
  double depth_at(Vec p) const;

  double cell_size() const { return size_; }
  double half() const { return cube_.half; }
  int side() const { return cube_.cells; }  // cells along an axis
  std::size_t cells() const { return extinction_.size(); }

 private:
  Cube cube_;
  double size_;                    // world, of a cell
  std::vector<float> extinction_;  // [cells, cells, cells] z, y, x; per world unit
};

}  // namespace ngs::orbit
