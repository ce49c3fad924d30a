#pragma once
// The two losses of BEA-GS (CVPR 2026, arXiv 2605.09662) with their gradients, for comparison. Class 1 is the object,
// class 0 the rest; a Gaussian's class is fixed.
//
//   L_bound = mean over pixels of the weight of Gaussians of the other class than the pixel's mask
//   L_occ   = Σ_i Σ_r α_i G_i(x_r) Q(x_r) / (N Z);   Q = 1 if none of the 27 voxels around x_r has a point of i's class
//
// The points are those of the rendered depth. Its voxels have side s = cbrt(4/3 π) d_k: they contain k points on
// average at the density that d_k, the distance of the k-th neighbour, gives. The published text leaves open: how x_r
// is drawn beyond "uniformly in UV space" (here: the square of ±3 standard deviations of the two longest axes), whether
// x_r moves with its Gaussian (here: it does not, else only α had a gradient), and from which points d_k is taken
// (here: the median of 200).
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "ngs/math/cell_grid.h"
#include "ngs/scene/gaussian_cloud.h"
#include "ngs/scene/rendered_view.h"

namespace ngs::bench {

/// The points of one class as occupied voxels.
class Voxels {
 public:
  /// `points` [M, 3] world. Fewer than two: everything is unsupported.
  Voxels(const std::vector<float>& points, int k, std::uint64_t seed);

  /// Whether one of the 27 voxels around a point is occupied.
  bool supports(const float* point) const { return near_.contains(grid_.of(point)); }
  double side() const { return side_; }

 private:
  double side_ = 0;
  CellGrid grid_{{0, 0, 0}, 1};
  std::unordered_set<std::uint64_t> near_;  // the occupied voxels and their neighbours
};

struct OccupancySamples {
  int per_gaussian = 20;
  std::uint64_t seed = 0, step = 0;
};

struct ClassedModel {
  const GaussianCloud& cloud;
  const std::vector<std::uint8_t>& object;  // [N] the classes
  const Voxels (&voxels)[2];                // of each class
};

/// Adds `weight` · ∂L_occ to the gradients and returns L_occ.
double add_occupancy_gradient(const ClassedModel& model, const OccupancySamples& samples, double weight,
                              CloudGradients& gradients);

/// `mask` [H·W] 1: object. Sets the gradients of label and alpha to `weight` · ∂L_bound and returns L_bound.
double boundary_gradient(const RenderedView& rendered, const std::vector<std::uint8_t>& mask, double weight,
                         ViewGradients& gradients);

}  // namespace ngs::bench
