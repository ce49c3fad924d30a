#pragma once
// The visual hull of an object's Gaussians that some view sees, from renders in all directions. The hidden Gaussians of
// the object are clipped to it.
#include <vector>

#include "ngs/edit/finish/support_view.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::finish {

/// Outline of Gaussians whose centre no view sees, standard deviations: large, since views hardly constrain them.
inline constexpr double kHiddenOutline = 2.5;

class SeenHull {
 public:
  /// `seen` [object] 1: a view sees the centre of this Gaussian. `ball`: contains the object. Renders the
  /// seen Gaussians alone from 40 directions.
  SeenHull(const Exec& exec, const GaussianCloud& object, const std::vector<std::uint8_t>& seen,
           const orbit::Ball& ball);

  bool is_hidden(std::size_t i) const { return !seen_[i]; }
  /// True for a hidden Gaussian in two cases. First, at least 4/5 of its 16 nearest neighbours are seen, so the surface
  /// is known there. Second, it is farther than 0.45 radii of the object from all seen Gaussians. If more than 1 % of
  /// the Gaussians are so far, the second case is ignored: they may be an unseen side of the object.
  bool is_surplus(std::size_t i) const { return surplus_[i] != 0; }
  /// False if the point lies outside the seen Gaussians' silhouettes from at least 1/20 of the directions, and from at
  /// least two. True without surplus Gaussians, and for a point farther from the ball's centre than twice its radius.
  bool contains(Vec3<double> point) const;

 private:
  std::vector<std::uint8_t> seen_, surplus_;
  std::vector<SupportView> views_;
  orbit::Ball ball_;
};

}  // namespace ngs::finish
