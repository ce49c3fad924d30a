#pragma once
// The dark ring around a removed object: where the object stood close, a surface is darker than its texture elsewhere.
#include "ngs/edit/fill/fill_texture.h"
#include "ngs/edit/fill/rim.h"

namespace ngs {

struct ContactShadow {
  double step = 1;           // world
  std::vector<double> left;  // factor in (0, 1] of the colour, by distance to the object in steps; not decreasing

  /// The factor at a distance to the object, world; 1 beyond the ring.
  double at(double distance) const {
    return distance < step * double(left.size()) ? left[std::size_t(distance / step)] : 1;
  }
};

/// Distances of points to the nearest Gaussian of the object that is not faint, world; infinite if there is none.
std::vector<double> distance_to_object(const Exec& exec, const Rim& rim, const std::vector<orbit::Vec>& points);

/// The ring in a texture with cells of `side`, `distance` [cells] to the object; empty: it is not clearly darker.
/// `diagonal`: of the object.
ContactShadow find_contact_shadow(const Exec& exec, const TextureGrid& texture, const std::vector<double>& distance,
                                  double side, double diagonal);

}  // namespace ngs
