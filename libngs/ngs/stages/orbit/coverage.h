#pragma once
// Which Gaussians a camera sees, and how much of a surface a set of cameras sees often enough.
//
// A Gaussian shows in a view where at least a quarter of its light, in the mean over the pixels that it reaches, gets
// past what lies before it. It belongs to the visible surface where at least half of it does in some view.
#include <cstdint>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/stages/orbit/surface_points.h"

namespace ngs::orbit {

inline constexpr int kWantedViews = 3;  // of each part of the surface

/// What one camera sees of the points of interest.
struct Sight {
  std::vector<std::uint32_t> shown;    // indices of points, increasing
  std::vector<std::uint32_t> surface;  // those of them of which it sees half or more
  double blocked = 0;                  // share of the light of the picture that lies before the points of interest
};

/// Points of a model seen with what stands about them.
class Sights {
 public:
  /// `cloud` as it is drawn, without colours' higher bands; `point_of_row` [cloud rows] index of the point of interest
  /// or -1. Both must outlive it.
  Sights(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::int32_t>& point_of_row);

  /// `nearer_than`: camera z before which other rows block, world.
  Sight of(const Exec& exec, const Camera& camera, double nearer_than) const;

 private:
  const GaussianCloud& cloud_;
  const std::vector<std::int32_t>& point_of_row_;
  SplatOptions splat_;
};

/// Counts how many of the chosen views show each point, weighted by what the points are worth.
class Coverage {
 public:
  /// `worth` [points] >= 0. `pool`: what all cameras that could be chosen see; what none sees is no visible surface.
  Coverage(std::vector<double> worth, const std::vector<Sight>& pool);

  void add(const Sight& sight);
  /// What a further view would add: worth of its points that fewer than kWantedViews views show.
  double gain(const Sight& sight) const;
  /// Share of the visible surface that at least kWantedViews views show, in [0, 1]; 1 where there is none.
  double share() const;
  std::size_t gaussians() const;  // points of the visible surface

 private:
  std::vector<double> worth_;        // 0: not on the visible surface
  std::vector<std::uint8_t> views_;  // up to kWantedViews
  double visible_ = 0;
};

}  // namespace ngs::orbit
