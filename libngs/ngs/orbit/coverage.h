#pragma once
// Which Gaussians are visible from a camera, and the fraction of a surface that enough cameras of a set show.
//
// A Gaussian is shown by a view if its mean transmittance over the pixels that it covers is at least 1/4. It belongs
// to the visible surface if this transmittance is at least 1/2 in some view.
#include <cstdint>
#include <vector>

#include "ngs/ops/splat/splat.h"
#include "ngs/scene/geometry/surface_points.h"

namespace ngs::orbit {

inline constexpr int kWantedViews = 3;  // views that each part of the surface should have

struct Visibility {
  std::vector<std::uint32_t> shown;    // indices of shown points, ascending
  std::vector<std::uint32_t> surface;  // those of them with a transmittance of at least 1/2
  double blocked = 0;                  // fraction of the image's weight that lies in front of the points of interest
};

/// Renders the visibility of a model's points of interest, with occlusion by the rest of the model.
class PointVisibility {
 public:
  /// `cloud` needs no SH bands above 0. `point_of_row` [cloud rows]: index of the point of interest, or -1. Both must
  /// outlive this object. `world_unit`: math/world_unit.h.
  PointVisibility(const Exec& exec, const GaussianCloud& cloud, const std::vector<std::int32_t>& point_of_row,
                  double world_unit = 1);

  /// Rows that are no point of interest count as blocking if their camera z (world units) is below `nearer_than`.
  Visibility of(const Exec& exec, const Camera& camera, double nearer_than) const;

 private:
  const GaussianCloud& cloud_;
  const std::vector<std::int32_t>& point_of_row_;
  SplatOptions splat_;
};

class Coverage {
 public:
  /// `weight` [points] >= 0. `pool`: the visibility from all candidate cameras; it defines the visible surface.
  Coverage(std::vector<double> weight, const std::vector<Visibility>& pool);

  void add(const Visibility& visibility);
  /// Gain of a further view: the weight of its shown points that fewer than kWantedViews chosen views show.
  double gain(const Visibility& visibility) const;
  /// Fraction of the visible surface that at least kWantedViews views show, in [0, 1]; 1 without a visible surface.
  double share() const;
  std::size_t gaussians() const;  // number of points of the visible surface

 private:
  std::vector<double> weight_;       // 0: not on the visible surface
  std::vector<std::uint8_t> views_;  // up to kWantedViews
  double visible_ = 0;
};

}  // namespace ngs::orbit
