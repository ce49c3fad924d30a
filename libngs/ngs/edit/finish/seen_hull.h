#pragma once
// The visual hull, from all directions, of an object's Gaussians that some view sees. The object's other Gaussians must
// not stick out of it.
#include <vector>

#include "ngs/edit/finish/support_view.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::finish {

/// Standard deviations up to which a Gaussian is tested whose centre no view sees: it contributes little to the views.
inline constexpr double kHiddenOutline = 2.5;

class SeenHull {
 public:
  /// `seen` [object] 1: a view sees the centre of this Gaussian. `ball`: contains the object. Renders the
  /// seen Gaussians alone from 40 directions.
  SeenHull(const Exec& exec, const GaussianCloud& object, const std::vector<std::uint8_t>& seen,
           const orbit::Ball& ball);

  bool is_hidden(std::size_t i) const { return !seen_[i]; }
  /// Whether the Gaussian is hidden although views see at least four fifths of the 16 nearest ones: the surface is
  /// known there. Or it is hidden and farther than 0.45 radii of the object from all that views see, unless more than
  /// one in a hundred Gaussians is: these may be an unseen side of the object.
  bool is_surplus(std::size_t i) const { return surplus_[i] != 0; }
  /// False if at least two of the directions, and a twentieth, show the point outside of the seen Gaussians. True
  /// without surplus Gaussians, and farther from the ball's centre than twice its radius.
  bool contains(Vec3<double> point) const;

 private:
  std::vector<std::uint8_t> seen_, surplus_;
  std::vector<SupportView> views_;
  orbit::Ball ball_;
};

}  // namespace ngs::finish
