#pragma once
// The dark ring around a removed object: where the object stood close, a surface is darker than its texture elsewhere.
#include "ngs/edit/fill/fill_texture.h"
#include "ngs/edit/fill/rim.h"

namespace ngs {

struct ContactShadow {
  std::vector<float> left;   // [cells] factor in (0, 1] of the colour; 1 beyond the ring. Empty: no ring was found
  std::vector<float> level;  // [cells] logarithm of the mean colour of the texture elsewhere

  /// The factor for an sh_dc in a cell: `left`, but no colour becomes brighter than `level`. `cell`
  /// -1: 1.
  double at(std::int64_t cell, const float* sh_dc) const;
};

/// The ring in `texture`, with cells of `side`. `distance` [cells] to the object, whose diagonal is `diagonal`.
ContactShadow find_contact_shadow(const Exec& exec, const TextureGrid& texture, const std::vector<double>& distance,
                                  double side, double diagonal);

/// Distances of points to the nearest Gaussian of the object that is not faint, world; infinite if there is none.
std::vector<double> distance_to_object(const Exec& exec, const Rim& rim, const std::vector<orbit::Vec>& points);

}  // namespace ngs
