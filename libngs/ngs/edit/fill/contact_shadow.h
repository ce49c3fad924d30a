#pragma once
// Finds the contact shadow of a removed object: the ring where a surface is darker than its texture farther away.
#include "ngs/edit/fill/fill_texture.h"
#include "ngs/edit/fill/rim.h"

namespace ngs {

struct ContactShadow {
  std::vector<float> shadow_factor;  // [cells] in (0, 1], of the colour; 1 beyond the ring. Empty: no ring was found
  std::vector<float> level;          // [cells] logarithm of the mean colour of the texture elsewhere

  /// The factor for a colour `sh_dc` in a cell: `shadow_factor`, bounded so that relighting makes no colour brighter
  /// than `level`. 1 for `cell` -1, which is outside the grid.
  double at(std::int64_t cell, const float* sh_dc) const;
};

/// Finds the ring. `distance` [cells] to the object, `side` of a cell, `diagonal` of the object's box: all world.
ContactShadow find_contact_shadow(const Exec& exec, const TextureGrid& texture, const std::vector<double>& distance,
                                  double side, double diagonal);

/// Distances of points to the nearest Gaussian of the object that is not faint, world; infinite if there is none.
std::vector<double> distance_to_object(const Exec& exec, const Rim& rim, const std::vector<orbit::Vec>& points);

}  // namespace ngs
