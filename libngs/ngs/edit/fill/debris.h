#pragma once
// Gaussians of the background that existed only because of the object: half-transparent smears around it, and what it
// enclosed.
#include <cstdint>
#include <vector>

#include "ngs/edit/fill/fill_surface.h"
#include "ngs/edit/fill/occluder.h"

namespace ngs {

/// [rim.background] 1: the Gaussian is off all surfaces, small enough to be within the object's place, and most of its
/// eight nearest solid neighbours were the object; at least half of them if it is half-transparent. Opaque needles
/// stay: they are rods and edges of other things. What the object enclosed goes always.
std::vector<std::uint8_t> find_debris(const Exec& exec, const GaussianCloud& cloud, const Rim& rim,
                                      const Occluder& occluder, const std::vector<FillSurface>& surfaces);

}  // namespace ngs
